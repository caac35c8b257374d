import { describe, expect, it } from 'vitest';
import { LANGUAGES, wordsOf } from '../../src/study/text';
import { en } from '../../src/study/text/en';

/** Every text of a language with its place; functions are called with numbers and words that any of them takes. */
function said(part: unknown, place = ''): [string, string][] {
  if (typeof part === 'string') return [[place, part]];
  if (typeof part === 'function') return [[place, String((part as (...with_: unknown[]) => unknown)(7, 9))]];
  return Object.entries(part as object).flatMap(([name, inner]) => said(inner, `${place}.${name}`));
}

/** Functions that take words, not numbers. */
const TAKE_WORDS = ['.flight.control', '.instructions.short'];

describe.each(Object.entries(LANGUAGES))('%s', (code, words) => {
  const texts = said(words).filter(([place]) => !TAKE_WORDS.includes(place));

  it('says everything', () => {
    expect(texts.map(([place]) => place)).toEqual(
      said(en)
        .map(([place]) => place)
        .filter((place) => !TAKE_WORDS.includes(place)),
    );
    expect(texts.filter(([, text]) => text.trim() === '' || text.includes('undefined'))).toEqual([]);
    expect(words.code).toBe(code);
  });

  it('names controls as any plant has them, by directions alone', () => {
    const named = ['left', 'right', 'up', 'down', 'x −', 'x +', 'y −', 'y +'].map(words.flight.control);
    const [left, right, up, down] = named;
    expect(named).toEqual([left, right, up, down, left, right, down, up]);
    expect(new Set(named).size).toBe(4);
    expect(words.flight.control('main')).toBe('main');
    expect(named.map(words.instructions.short)).toEqual(named);
  });

  it('speaks of no lander: what is steered may be a drone, an arm, or what nobody has made yet', () => {
    const lander = /engine|triebwerk|craft|fluggerät|ground|boden|in the air|in der luft|land|hatched|schraffiert/i;
    const controls = ['left', 'right', 'main', 'up', 'down'].map((name) => [name, words.flight.control(name)]);
    expect([...texts, ...controls].filter(([, text]) => lander.test(text!))).toEqual([]);
  });

  it('names no rule and no co-pilot', () => {
    expect(texts.filter(([, text]) => /\b(HIC|LASC|MISC|co-pilot|robot)/i.test(text))).toEqual([]);
  });
});

describe('the language', () => {
  it('is found by its code, with or without a country, and is English if there are no words', () => {
    expect(wordsOf('de-AT').code).toBe('de');
    expect(wordsOf('fr').code).toBe('en');
  });
});
