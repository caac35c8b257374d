// @vitest-environment jsdom
// What the page says of rules, actions, endings and what was typed.

import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { readSeed } from '../src/controls';
import { actionsOf, rangesOf, usualRule, usualRules, whyNotParameter, withParameters } from '../src/rules';
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

  it('are those of the program, with its usual parameters for commands', () => {
    const source = readFileSync('../crates/cohelm/src/arbitration/rule.rs', 'utf8');
    const kappa = /DEFAULT_KAPPA: f64 = ([\d.]+)/.exec(source)![1]!;
    const listed = /USUAL: \[Self; 12\] = \[([^\]]*)\]/.exec(source)![1]!.replace('DEFAULT_KAPPA', kappa);
    const theirs = [...listed.matchAll(/Self::(\w+)(?: \{([^}]*)\})?/g)].map(([, name, parameters = '']) => {
      const numbers = [...parameters.matchAll(/(\w+): ([\d.]+)/g)].map(([, name, value]) => [name, Number(value)]);
      return [name!.replace(/(?<!^)[A-Z]/g, '-$&').toLowerCase(), ...numbers];
    });
    const ours = usualRules('commands').map((rule) => [
      rule.rule,
      ...rangesOf(rule).map(([name, value]) => [name, value]),
    ]);
    expect(ours.sort()).toEqual(theirs.sort());
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
