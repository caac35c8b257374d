//! What the rules promise, over random values, likenesses and confidences (Section III-C and its extremes).

use cohelm::action::Action;
use cohelm::arbitration::{Arbiter, Likeness, Pick, Rule, RuleError, Stage};
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

const THRESHOLD_RULES: [Rule; 3] = [Rule::Misc, Rule::Tolerance { alpha: 0.4 }, Rule::MiscR { kappa: 0.7 }];

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
    assert_eq!(error(Rule::MiscR { kappa: 0.7 }, 0.0), RuleError::MedianRange(0.0));
    assert!(error(Rule::MiscR { kappa: f64::NAN }, 1.0).to_string().contains("finite"));
}
