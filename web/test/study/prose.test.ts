// @vitest-environment jsdom
import { describe, expect, it } from 'vitest';
import { prose } from '../../src/study/prose';

const html = (text: string) => prose(text).innerHTML;

describe('restricted Markdown', () => {
  it('has paragraphs, lists, headings, bold and emphasis', () => {
    expect(html('One\nline.\n\nTwo **bold** *soft*.')).toBe(
      '<p>One line.</p><p>Two <strong>bold</strong> <em>soft</em>.</p>',
    );
    expect(html('- a\n- b\n  goes on')).toBe('<ul><li>a</li><li>b goes on</li></ul>');
    expect(html('1. a\n2. b')).toBe('<ol><li>a</li><li>b</li></ol>');
    expect(html('## Data')).toBe('<h3>Data</h3>');
  });

  it('links to https and to nothing else', () => {
    expect(html('[us](https://example.org/a)')).toContain('href="https://example.org/a"');
    expect(prose('[x](javascript:alert(1)) [y](http://example.org)').querySelector('a')).toBeNull();
  });

  it('takes HTML for text', () => {
    expect(html('<img src=x onerror=alert(1)>')).toBe('<p>&lt;img src=x onerror=alert(1)&gt;</p>');
  });
});
