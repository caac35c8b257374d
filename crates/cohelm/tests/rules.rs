//! What the rules promise, over random values, likenesses and confidences (Section III-C and its extremes).

use cohelm::action::Action;
use cohelm::arbitration::{
    Arbiter, FLIGHTS, GoalValues, Last, Likeness, LookAhead, Pick, Rule, RuleError, Stage,
};
use cohelm::intent::Belief;
use cohelm::value::ActionValues;
use proptest::prelude::*;

/// A tick in which one of the candidates is asked.
#[derive(Clone, Debug)]
struct Case {
    values: Vec<f32>,
    likeness: Vec<Likeness>,
    asked: usize,
    confidence: f32,
}

fn cases() -> impl Strategy<Value = Case> {
    let sizes = 1_usize..9;
    sizes.prop_flat_map(|n| {
        // Values on a grid of 1/64 tie often and can be shifted and scaled without rounding.
        let values = prop::collection::vec((-512_i32..512).prop_map(|x| x as f32 / 64.0), n);
        let similarities = prop::collection::vec(prop::sample::select(vec![-1.0_f32, 0.0, 1.0]), n);
        (values, similarities, 0..n, 0.0_f32..=1.0).prop_map(|(values, similarities, asked, confidence)| {
            let alike = |(i, similarity)| {
                let same = i == asked;
                Likeness {
                    similarity: if same { 1.0 } else { similarity },
                    same_label: same,
                    same_effect: same,
                }
            };
            let likeness = similarities.into_iter().enumerate().map(alike).collect();
            Case { values, likeness, asked, confidence }
        })
    })
}

fn believed(confidence: f32) -> Belief {
    let mut belief = Belief::unknown(3, 0);
    belief.confidence = confidence;
    belief
}

fn decide(rule: Rule, case: &Case) -> (Pick, Vec<bool>) {
    let candidates = (0..case.values.len()).map(|i| Action::Command(i as u8)).collect();
    let values = ActionValues::new(candidates, case.values.clone()).unwrap();
    let belief = believed(case.confidence);
    let stage = Stage::new(&values, Some(&case.likeness), &belief);
    let mut allowed = vec![false; case.values.len()];
    (rule.arbiter(1.0).unwrap().decide(&stage, &mut allowed), allowed)
}

fn with(case: &Case, change: impl FnOnce(&mut Case)) -> Case {
    let mut other = case.clone();
    change(&mut other);
    other
}

fn is_subset(small: &[bool], large: &[bool]) -> bool {
    small.iter().zip(large).all(|(small, large)| !small || *large)
}

fn highest(values: &[f32]) -> f32 {
    values.iter().copied().fold(f32::NEG_INFINITY, f32::max)
}

const THRESHOLD_RULES: [Rule; 4] = [
    Rule::Misc,
    Rule::Tolerance { alpha: 0.4 },
    Rule::MiscR { kappa: 0.7 },
    Rule::MiscH { kappa: 0.7, release: 0.5 },
];

proptest! {
    #[test]
    fn without_confidence_misc_carries_out_what_was_asked(case in cases()) {
        let (pick, _) = decide(Rule::Misc, &with(&case, |case| case.confidence = 0.0));
        prop_assert_eq!(pick, Pick::Candidate(case.asked));
    }

    #[test]
    fn with_full_confidence_misc_carries_out_only_a_best_action(case in cases(), offset in -1e6_f32..1e6) {
        let sure = with(&case, |case| {
            case.confidence = 1.0;
            case.values.iter_mut().for_each(|value| *value += offset);
        });
        let (Pick::Candidate(chosen), _) = decide(Rule::Misc, &sure) else { panic!("misc picks a candidate") };
        prop_assert_eq!(sure.values[chosen], highest(&sure.values));
    }

    #[test]
    fn a_larger_confidence_never_enlarges_the_allowed_set(case in cases(), more in 0.0_f32..=1.0) {
        let larger = with(&case, |case| case.confidence = case.confidence.max(more));
        prop_assert!(is_subset(&decide(Rule::Misc, &larger).1, &decide(Rule::Misc, &case).1));
    }

    #[test]
    fn scaling_and_shifting_all_values_changes_nothing(case in cases(), power in -10_i32..10, shift in -64_i32..64) {
        let other = with(&case, |case| {
            case.values.iter_mut().for_each(|value| *value = (*value + shift as f32) * 2.0_f32.powi(power));
        });
        prop_assert_eq!(decide(Rule::Misc, &case), decide(Rule::Misc, &other));
    }

    #[test]
    fn a_larger_kappa_never_shrinks_the_allowed_set(case in cases(), kappa in 0.0_f64..3.0, more in 0.0_f64..3.0) {
        let small = decide(Rule::MiscR { kappa }, &case).1;
        let large = decide(Rule::MiscR { kappa: kappa + more }, &case).1;
        prop_assert!(is_subset(&small, &large));
    }

    #[test]
    fn regret_does_not_care_about_confidence_or_shifts(case in cases(), shift in -64_i32..64) {
        let other = with(&case, |case| {
            case.confidence = 1.0 - case.confidence;
            case.values.iter_mut().for_each(|value| *value += shift as f32);
        });
        let rule = Rule::MiscR { kappa: 0.7 };
        prop_assert_eq!(decide(rule, &case), decide(rule, &other));
    }

    #[test]
    fn the_chosen_action_is_the_most_similar_of_the_whole_allowed_set(case in cases()) {
        for rule in THRESHOLD_RULES {
            let (Pick::Candidate(chosen), allowed) = decide(rule, &case) else { panic!("{rule:?} picks a candidate") };
            prop_assert!(allowed[chosen]);
            for other in (0..allowed.len()).filter(|&i| allowed[i]) {
                prop_assert!(case.likeness[chosen] >= case.likeness[other]);
                let tied = case.likeness[chosen] == case.likeness[other];
                prop_assert!(!tied || case.values[chosen] >= case.values[other]);
                prop_assert!(!tied || case.values[chosen] > case.values[other] || chosen <= other);
            }
        }
    }

    #[test]
    fn a_best_action_is_always_allowed(case in cases()) {
        for rule in THRESHOLD_RULES {
            let allowed = decide(rule, &case).1;
            let best = highest(&case.values);
            prop_assert!(case.values.iter().zip(allowed).all(|(&value, allowed)| value < best || allowed));
        }
    }

    #[test]
    fn equal_values_let_the_person_through(case in cases(), value in -1e9_f32..1e9) {
        let equal = with(&case, |case| case.values.fill(value));
        for rule in THRESHOLD_RULES {
            prop_assert_eq!(decide(rule, &equal).0, Pick::Candidate(case.asked));
        }
        for rule in [Rule::Hindsight { likeness: 0.0 }, Rule::Hindsight { likeness: 0.5 }, Rule::Ida] {
            let pick = decide(rule, &equal).0;
            prop_assert!(pick == Pick::Asked || pick == Pick::Candidate(case.asked), "{:?}: {:?}", rule, pick);
        }
    }

    #[test]
    fn misc_is_a_constant_tolerance_at_one_minus_its_confidence(case in cases(), eighths in 0_u8..=8) {
        let share = f32::from(eighths) / 8.0;
        let misc = decide(Rule::Misc, &with(&case, |case| case.confidence = share));
        prop_assert_eq!(misc, decide(Rule::Tolerance { alpha: 1.0 - f64::from(share) }, &case));
    }
}

/// Three values 0, 5 and 10; the worst is asked.
fn three(confidence: f32) -> Case {
    let likeness = |similarity, same| Likeness { similarity, same_label: same, same_effect: same };
    Case {
        values: vec![0.0, 5.0, 10.0],
        likeness: vec![likeness(1.0, true), likeness(0.0, false), likeness(-1.0, false)],
        asked: 0,
        confidence,
    }
}

#[test]
fn misc_corrects_no_more_than_its_confidence_asks_for() {
    assert_eq!(decide(Rule::Misc, &three(0.0)).0, Pick::Candidate(0));
    assert_eq!(decide(Rule::Misc, &three(0.5)).0, Pick::Candidate(1));
    assert_eq!(decide(Rule::Misc, &three(0.51)).0, Pick::Candidate(2));
}

#[test]
fn misc_r_allows_a_regret_in_the_values_own_units() {
    assert_eq!(decide(Rule::MiscR { kappa: 4.9 }, &three(0.5)).1, [false, false, true]);
    assert_eq!(decide(Rule::MiscR { kappa: 5.0 }, &three(0.5)).1, [false, true, true]);
    assert_eq!(decide(Rule::MiscR { kappa: 10.0 }, &three(0.5)).0, Pick::Candidate(0));
}

#[test]
fn linear_arbitration_weighs_the_robot_by_the_confidence() {
    assert_eq!(decide(Rule::Lasc, &three(0.7)).0, Pick::Blend { robot: 2, weight: 0.7 });
    assert_eq!(decide(Rule::Hic, &three(0.7)).0, Pick::Asked);
    assert_eq!(decide(Rule::Robot, &three(0.7)).0, Pick::Candidate(2));
}

#[test]
fn with_nothing_asked_only_the_person_alone_does_nothing() {
    let candidates = (0..3).map(Action::Command).collect();
    let values = ActionValues::new(candidates, vec![0.0, 5.0, 10.0]).unwrap();
    let belief = believed(0.2);
    let stage = Stage::new(&values, None, &belief);
    let pick = |rule: Rule| rule.arbiter(1.0).unwrap().decide(&stage, &mut [false; 3]);
    assert_eq!(pick(Rule::Hic), Pick::Nothing);
    for rule in THRESHOLD_RULES.into_iter().chain([Rule::Lasc, Rule::Robot]) {
        assert_eq!(pick(rule), Pick::Candidate(2), "{rule:?}");
    }
}

#[test]
fn parameters_out_of_range_are_refused_with_the_range() {
    let error = |rule: Rule, range| rule.arbiter(range).map(|_: Box<dyn Arbiter>| ()).unwrap_err();
    assert_eq!(error(Rule::Tolerance { alpha: 1.5 }, 1.0), RuleError::Alpha(1.5));
    assert_eq!(error(Rule::MiscR { kappa: -1.0 }, 1.0), RuleError::Kappa(-1.0));
    let no_range = RuleError::MedianRange { rule: "misc-r", got: 0.0 };
    assert_eq!(error(Rule::MiscR { kappa: 0.7 }, 0.0), no_range);
    assert!(error(Rule::MiscR { kappa: f64::NAN }, 1.0).to_string().contains("finite"));
    for (rule, words) in [
        (Rule::LineGraph { start: 0.5, full: 0.4, most: 1.0 }, "at least as large as start, got 0.4"),
        (
            Rule::LineGraph { start: 0.5, full: 0.6, most: 1.1 },
            "most of rule line-graph must be a number in [0, 1]",
        ),
        (Rule::Threshold { confidence: f64::NAN }, "confidence of rule threshold"),
        (Rule::Hindsight { likeness: -1.0 }, "at least 0"),
        (Rule::MiscH { kappa: 1.0, release: 2.0 }, "release of rule misc-h"),
        (Rule::SafeNearest { hold: 501, horizon: 3 }, "from 0 to 500, got 501"),
    ] {
        let error = error(rule, 1.0).to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_rule_is_found_by_its_word_and_set_by_its_parameters_names() {
    for rule in Rule::USUAL {
        assert_eq!(Rule::named(rule.word()), Ok(rule));
        let set = |rule: Rule, (name, value): (&str, f64)| rule.with(name, value).unwrap();
        let doubled = rule.parameters().into_iter().map(|(name, value)| (name, value * 2.0));
        let changed = doubled.clone().fold(rule, set);
        assert_eq!(changed.parameters(), doubled.collect::<Vec<_>>());
        let written = serde_json::to_value(rule).unwrap();
        assert_eq!(written["rule"], rule.word());
        assert_eq!(serde_json::from_value::<Rule>(written).unwrap(), rule);
        assert!(rule.arbiter(1.0).is_ok());
    }
    let unknown = Rule::named("mics").unwrap_err().to_string();
    assert!(unknown.contains("\"mics\"") && unknown.contains("misc-r"), "{unknown}");
    let foreign = Rule::Threshold { confidence: 0.5 }.with("alpha", 0.5).unwrap_err().to_string();
    assert_eq!(foreign, "the rule threshold has no alpha; it has: confidence");
    assert!(Rule::SafeNearest { hold: 1, horizon: 2 }.with("hold", 1.5).is_err(), "half a tick");
}

#[test]
fn the_line_graph_is_nothing_then_a_line_then_constant() {
    let rule = Rule::LineGraph { start: 0.25, full: 0.75, most: 0.5 };
    for (confidence, weight) in [(0.0, 0.0), (0.25, 0.0), (0.5, 0.25), (0.75, 0.5), (1.0, 0.5)] {
        assert_eq!(decide(rule, &three(confidence)).0, Pick::Blend { robot: 2, weight });
    }
    let lasc = Rule::LineGraph { start: 0.0, full: 1.0, most: 1.0 };
    assert_eq!(decide(lasc, &three(0.3)), decide(Rule::Lasc, &three(0.3)));
    let step = Rule::LineGraph { start: 0.5, full: 0.5, most: 1.0 };
    assert_eq!(decide(step, &three(0.6)).0, Pick::Blend { robot: 2, weight: 1.0 });
}

#[test]
fn the_threshold_takes_over_above_its_confidence_and_not_at_it() {
    let rule = Rule::Threshold { confidence: 0.5 };
    assert_eq!(decide(rule, &three(0.5)).0, Pick::Asked);
    assert_eq!(decide(rule, &three(0.51)).0, Pick::Candidate(2));
}

/// A decision with values for every goal, of which the first is the inferred one.
fn decide_for(rule: Rule, of_goals: &[[f32; 3]], probabilities: &[f32], asked: usize) -> Pick {
    decide_for_goals(rule, of_goals, probabilities, Some(asked)).0
}

/// The same, and which candidates were allowed.
fn decide_for_goals(
    rule: Rule,
    of_goals: &[[f32; 3]],
    probabilities: &[f32],
    asked: Option<usize>,
) -> (Pick, [bool; 3]) {
    let candidates = (0..3).map(Action::Command).collect();
    let values = ActionValues::new(candidates, of_goals[0].to_vec()).unwrap();
    let belief = Belief::from_probabilities(probabilities);
    let likeness = [0, 1, 2].map(|i| {
        let same = Some(i) == asked;
        Likeness { similarity: if same { 1.0 } else { 0.0 }, same_label: same, same_effect: same }
    });
    let all = of_goals.concat();
    let mut stage = Stage::new(&values, asked.map(|_| &likeness[..]), &belief);
    stage.of_goals = GoalValues::new(&all, 3);
    let arbiter = rule.arbiter(1.0).unwrap();
    assert!(arbiter.needs().every_goal);
    let mut allowed = [false; 3];
    (arbiter.decide(&stage, &mut allowed), allowed)
}

#[test]
fn with_nothing_asked_hindsight_flies_the_average_and_the_hedged_rule_the_likeliest_goal() {
    let goals = [[1.0, 0.8, 0.0], [0.0, 0.8, 1.0]];
    let silent = |rule| decide_for_goals(rule, &goals, &[0.5, 0.5], None);
    let of_hindsight = silent(Rule::Hindsight { likeness: 0.4 });
    assert_eq!(of_hindsight, (Pick::Candidate(1), [false, true, false]));
    let of_hedged = silent(Rule::MiscH { kappa: 1.0, release: 0.5 });
    assert_eq!(of_hedged, (Pick::Candidate(0), [true, false, false]));
}

#[test]
fn hindsight_hedges_between_the_goals_and_pays_for_departing_from_what_is_asked() {
    // The first goal wants 0, the second 2; action 1 is nearly as good for both.
    let goals = [[1.0, 0.8, 0.0], [0.0, 0.8, 1.0]];
    let pick = |likeness, p: [f32; 2], asked| decide_for(Rule::Hindsight { likeness }, &goals, &p, asked);
    assert_eq!(pick(0.0, [0.5, 0.5], 0), Pick::Candidate(1));
    assert_eq!(pick(0.0, [0.95, 0.05], 2), Pick::Candidate(0));
    assert_eq!(pick(0.2, [0.5, 0.5], 0), Pick::Candidate(1), "0.5 + 0.2 is less than 0.8");
    assert_eq!(pick(0.4, [0.5, 0.5], 0), Pick::Candidate(0), "0.5 + 0.4 is more than 0.8");
}

#[test]
fn the_robot_acts_only_if_it_is_better_whatever_the_goal() {
    let agreed = [[1.0, 0.5, 0.0], [0.6, 0.2, 0.0]];
    assert_eq!(decide_for(Rule::Ida, &agreed, &[0.5, 0.5], 2), Pick::Candidate(0));
    let torn = [[1.0, 0.5, 0.0], [0.0, 0.2, 0.1]];
    assert_eq!(
        decide_for(Rule::Ida, &torn, &[0.99, 0.01], 2),
        Pick::Asked,
        "however unlikely the second goal"
    );
    let tied = [[1.0, 1.0, 0.0], [0.6, 0.6, 0.0]];
    assert_eq!(decide_for(Rule::Ida, &tied, &[0.5, 0.5], 1), Pick::Asked, "as good is not better");
}

#[test]
fn hedged_regret_excuses_what_is_good_for_a_likely_goal_and_holds_on_after_an_intervention() {
    let goals = [[1.0, 0.4, 0.0], [0.0, 0.4, 1.0]];
    let pick = |kappa, p: [f32; 2]| decide_for(Rule::MiscH { kappa, release: 0.5 }, &goals, &p, 2);
    assert_eq!(pick(0.6, [0.75, 0.25]), Pick::Candidate(2), "0.75 − 0.25 is less than 0.6");
    assert_eq!(pick(0.4, [0.75, 0.25]), Pick::Candidate(0), "and more than 0.4");
    assert_eq!(pick(0.4, [0.5, 0.5]), Pick::Candidate(2), "as good as any on average");

    let case = three(0.5);
    let values = ActionValues::new((0..3).map(Action::Command).collect(), vec![0.4, 0.0, 1.0]).unwrap();
    let belief = believed(0.5);
    let mut stage = Stage::new(&values, Some(&case.likeness), &belief);
    let rule = Rule::MiscH { kappa: 1.0, release: 0.5 }.arbiter(1.0).unwrap();
    assert_eq!(rule.decide(&stage, &mut [false; 3]), Pick::Candidate(0), "0.6 is less than 1");
    let last = Last { asked: None, executed: None, intervened: true };
    stage.last = Some(last);
    assert_eq!(rule.decide(&stage, &mut [false; 3]), Pick::Candidate(2), "and more than the half of it");
    stage.last = Some(Last { intervened: false, ..last });
    assert_eq!(rule.decide(&stage, &mut [false; 3]), Pick::Candidate(0));
}

/// Knows which candidates are safe, and how often it was asked.
struct Oracle {
    safe: Vec<bool>,
    asked: std::cell::RefCell<Vec<usize>>,
}

impl LookAhead for Oracle {
    fn is_safe(&self, candidate: usize, _hold: u32, _horizon: u32) -> bool {
        self.asked.borrow_mut().push(candidate);
        self.safe[candidate]
    }
}

#[test]
fn safe_nearest_tries_the_nearest_first_and_stops_at_the_first_that_is_safe() {
    let tried = |safe: [bool; 3], likeness: bool| {
        let case = three(0.5);
        let values = ActionValues::new((0..3).map(Action::Command).collect(), case.values).unwrap();
        let (belief, ahead) = (believed(0.5), Oracle { safe: safe.into(), asked: Vec::new().into() });
        let mut stage = Stage::new(&values, likeness.then_some(&case.likeness), &belief);
        stage.ahead = Some(&ahead);
        let mut allowed = [false; 3];
        let arbiter = Rule::SafeNearest { hold: 5, horizon: 30 }.arbiter(1.0).unwrap();
        assert!(arbiter.needs().look_ahead);
        let pick = arbiter.decide(&stage, &mut allowed);
        (pick, allowed, ahead.asked.into_inner())
    };
    assert_eq!(tried([true; 3], true), (Pick::Candidate(0), [true, false, false], vec![0]));
    assert_eq!(tried([false, true, true], true), (Pick::Candidate(1), [false, true, false], vec![0, 1]));
    assert_eq!(tried([false; 3], true), (Pick::Candidate(2), [false, false, true], vec![0, 1, 2]));
    assert_eq!(
        tried([true; 3], false),
        (Pick::Candidate(2), [false, false, true], vec![]),
        "nothing is asked"
    );
}

#[test]
fn of_many_candidates_safe_nearest_tries_some_from_the_nearest_to_the_farthest() {
    let likeness: Vec<Likeness> = (0..128)
        .map(|index| Likeness {
            similarity: -(index as f32),
            same_label: index == 0,
            same_effect: index == 0,
        })
        .collect();
    let mut worth = vec![0.0; 128];
    worth[127] = 1.0;
    let candidates = (0..128).map(|index| Action::axes(&[index as f32 / 127.0])).collect();
    let values = ActionValues::new(candidates, worth).unwrap();
    let (belief, arbiter) = (believed(0.5), Rule::SafeNearest { hold: 5, horizon: 30 }.arbiter(1.0).unwrap());
    let tried = |safe: Vec<bool>| {
        let ahead = Oracle { safe, asked: Vec::new().into() };
        let mut stage = Stage::new(&values, Some(&likeness), &belief);
        stage.ahead = Some(&ahead);
        let mut allowed = [false; 128];
        let pick = arbiter.decide(&stage, &mut allowed);
        assert_eq!(allowed.iter().filter(|&&allowed| allowed).count(), 1);
        (pick, ahead.asked.into_inner())
    };
    let some: Vec<usize> = (0..128).step_by(13).collect();
    assert!(some.len() <= FLIGHTS);
    assert_eq!(tried(vec![false; 128]), (Pick::Candidate(127), some.clone()));
    let from_the_fifteenth = (0..128).map(|index| index > 13).collect();
    assert_eq!(tried(from_the_fifteenth), (Pick::Candidate(26), some[..3].to_vec()));
}
