// Restricted Markdown, as a study's texts have it: paragraphs, lists, headings, bold, emphasis, and links to https. Made
// of elements, never of HTML, so that a text can say nothing to the browser.

import { element } from '../dom';

const INLINE = /\*\*(.+?)\*\*|\*(.+?)\*|\[([^\]]+)\]\((https:\/\/[^\s)]+)\)/g;

/** The elements of a text. */
export function prose(text: string): HTMLElement {
  const blocks = text
    .replaceAll('\r', '')
    .split(/\n\s*\n/)
    .filter((block) => block.trim() !== '');
  return element('div', { class: 'prose' }, ...blocks.map(block));
}

function block(text: string): HTMLElement {
  const lines = text.trim().split('\n');
  const heading = /^#{1,3}\s+(.*)$/.exec(lines[0]!);
  if (heading !== null && lines.length === 1) return element('h3', {}, ...inline(heading[1]!));
  const [bullets, numbers] = [/^\s*[-*]\s+/, /^\s*\d+[.)]\s+/];
  for (const [mark, name] of [[bullets, 'ul'] as const, [numbers, 'ol'] as const]) {
    if (mark.test(lines[0]!))
      return element(name, {}, ...itemsOf(lines, mark).map((item) => element('li', {}, ...inline(item))));
  }
  return element('p', {}, ...inline(lines.map((line) => line.trim()).join(' ')));
}

/** A line without a mark goes on with the item above it. */
function itemsOf(lines: string[], mark: RegExp): string[] {
  const items: string[] = [];
  for (const line of lines) {
    if (mark.test(line)) items.push(line.replace(mark, '').trim());
    else items.push(`${items.pop() ?? ''} ${line.trim()}`.trim());
  }
  return items;
}

/** Bold, emphasis and links within a line; everything else is text. */
function inline(text: string): (Node | string)[] {
  const parts: (Node | string)[] = [];
  let at = 0;
  for (const match of text.matchAll(INLINE)) {
    parts.push(text.slice(at, match.index));
    const [whole, bold, emphasis, label, address] = match;
    if (bold !== undefined) parts.push(element('strong', {}, ...inline(bold)));
    else if (emphasis !== undefined) parts.push(element('em', {}, emphasis));
    else parts.push(element('a', { href: address!, target: '_blank', rel: 'noopener noreferrer' }, label!));
    at = match.index + whole.length;
  }
  parts.push(text.slice(at));
  return parts.filter((part) => part !== '');
}
