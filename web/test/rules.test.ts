// @vitest-environment jsdom
// What the page says of rules, actions, endings and what was typed.

import { describe, expect, it } from 'vitest';
import { readSeed } from '../src/controls';
import { actionsOf, usualRule, whyNotParameter, withParameters } from '../src/rules';
import { endingHint, ruleSaid } from '../src/words';

describe('rules', () => {
  it('are told apart by the kind of actions: mixed on axes and levers, switched among commands', () => {
    const kinds = [
      ['left on', 'left off'],
      ['off + left', 'on + none'],
      ['x −', 'x +'],
    ].map(actionsOf);
    expect(kinds).toEqual(['commands', 'levers', 'axes']);
    const linear = kinds.map((kind) => ruleSaid('lasc', kind));
    expect(linear.map((text) => /c > 0\.5/.test(text))).toEqual([true, false, false]);
    expect(linear[2]).toContain('c · robot + (1 − c) · person');
  });

  it('keep parameters that make sense and no others', () => {
    const rule = usualRule('line-graph', 'commands');
    expect(whyNotParameter(rule, 'full', 0.1)).toContain('start');
    expect(withParameters(rule, { full: 0.1, most: 0.5, start: 'a' })).toEqual({ ...rule, most: 0.5 });
    expect(withParameters(usualRule('misc-r', 'axes'), { kappa: NaN })).toEqual({ rule: 'misc-r', kappa: 0.2 });
  });
});

describe('an ending', () => {
  it('is praised only if the person flew', () => {
    expect(endingHint('elsewhere', { robot: false, commands: 0 })).not.toContain('Well done');
    expect(endingHint('elsewhere', { robot: false, commands: 3 })).toContain('Well done');
    expect(endingHint('goal', { robot: true, commands: 0 })).not.toContain('you');
  });
});

describe('a seed', () => {
  it('is a whole number or none', () => {
    expect([readSeed(''), readSeed('7')]).toEqual([{ seed: null }, { seed: 7 }]);
    for (const wrong of ['-5', '1.5', '1e23']) expect(readSeed(wrong)).toContain(`got ${wrong}`);
    expect(readSeed('', true)).toContain('whole number');
  });
});
