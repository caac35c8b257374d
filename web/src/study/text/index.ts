// Which language the page speaks.

import { de } from './de';
import { en, type Words } from './en';

export type { Words } from './en';

/** One file a language; to add one, write its file and name it here. */
export const LANGUAGES: Record<string, Words> = { en, de };

/** The words of a language, by its code with or without a country; English if there are none. */
export function wordsOf(language: string): Words {
  return LANGUAGES[language] ?? LANGUAGES[language.split('-')[0]!.toLowerCase()] ?? en;
}
