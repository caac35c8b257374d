//! Each instrument against an example worked by hand from the rule of its source, and what every file must keep to.

use super::*;
use serde_json::json;

fn scores(name: &str, answers: &Value) -> Vec<(String, Option<f64>)> {
    instrument(name).expect("built in").score(answers)
}

fn score(name: &str, score: &str, answers: &Value) -> Option<f64> {
    scores(name, answers).into_iter().find(|(known, _)| known == score).expect("there is such a score").1
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("every item was answered");
    assert!((found - expected).abs() < 1e-12, "expected {expected}, got {found}");
}

/// Answers to the items of an instrument in their order.
fn answered(name: &str, answers: &[f64]) -> Value {
    let items = &instrument(name).expect("built in").items;
    assert_eq!(items.len(), answers.len());
    items
        .iter()
        .zip(answers)
        .map(|(item, answer)| (item.id.clone(), json!(answer)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// Table I of the paper prints the mean of each statement and no sum: 7.9, 8.2, 9.3, 1.2 and 8.6 for MISC. Ten answers
/// to "I was troubled" that have its mean: 0 0 1 1 1 1 1 2 2 3 → 12 / 10 = 1.2.
#[test]
fn the_papers_statements_are_scores_of_their_own() {
    let names: Vec<String> = scores("paper-survey", &json!({})).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["helpful", "did-what-i-wanted", "accomplished-better", "troubled", "satisfied"]);
    let troubled = [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 3.0];
    let each = troubled.map(|answer| {
        score("paper-survey", "troubled", &answered("paper-survey", &[8.0, 8.0, 9.0, answer, 9.0]))
    });
    near(Some(each.iter().flatten().sum::<f64>() / 10.0), 1.2);
    assert_eq!(instrument("paper-survey").expect("built in").range("troubled"), Some((0.0, 10.0)));
}

/// Hart (2006): the raw TLX is the mean of the six ratings, without weights. Performance is rated from perfect (0) to
/// failure (100), so it adds to the load as it stands. By hand: 70 + 20 + 60 + 35 + 65 + 50 = 300; 300 / 6 = 50.
#[test]
fn nasa_tlx_is_the_mean_of_six_ratings() {
    let answers = answered("nasa-tlx", &[70.0, 20.0, 60.0, 35.0, 65.0, 50.0]);
    near(score("nasa-tlx", "overall", &answers), 50.0);
    near(score("nasa-tlx", "performance", &answers), 35.0);
    let tlx = instrument("nasa-tlx").expect("built in");
    assert_eq!(tlx.range("overall"), Some((0.0, 100.0)));
    let performance = tlx.items.iter().find(|item| item.id == "performance").expect("one of the six");
    assert!(!performance.reversed, "its right end is failure already");
    for (_, scale) in tlx.scales() {
        assert_eq!((scale.step, scale.points()), (5.0, 21), "the sheet has 21 marks");
    }
}

/// Jian, Bisantz & Drury (2000), as McGrath et al. (2025) score it: items 1 to 5 speak of distrust and are turned round
/// (8 − x), then the mean of all twelve. By hand: distrust 2 1 3 4 1 → 6 7 5 4 7 = 29; trust 5 4 5 6 6 5 3 = 34;
/// 29 + 34 = 63; 63 / 12 = 5.25.
#[test]
fn trust_turns_its_first_five_items_round() {
    let answers = answered("trust", &[2.0, 1.0, 3.0, 4.0, 1.0, 5.0, 4.0, 5.0, 6.0, 6.0, 5.0, 3.0]);
    near(score("trust", "overall", &answers), 5.25);
    let reversed =
        instrument("trust").expect("built in").items.iter().map(|item| item.reversed).collect::<Vec<_>>();
    assert_eq!(reversed, [[true; 5].as_slice(), &[false; 7]].concat());
    near(score("trust", "overall", &answered("trust", &[[1.0; 5].as_slice(), &[7.0; 7]].concat())), 7.0);
}

/// Tapal et al. (2017): two factors that are scored apart, positive agency (items 1, 4, 8, 9, 12, 13) and negative agency
/// (2, 3, 5, 6, 7, 10, 11). By hand, answers 6 2 1 5 3 2 4 6 7 1 2 4 5: positive 6 + 5 + 6 + 7 + 4 + 5 = 33, 33 / 6 = 5.5;
/// negative 2 + 1 + 3 + 2 + 4 + 1 + 2 = 15, 15 / 7.
#[test]
fn agency_has_a_positive_and_a_negative_score() {
    let answers = answered("agency", &[6.0, 2.0, 1.0, 5.0, 3.0, 2.0, 4.0, 6.0, 7.0, 1.0, 2.0, 4.0, 5.0]);
    let names: Vec<String> = scores("agency", &answers).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["positive", "negative"], "the two are no scale together");
    near(score("agency", "positive", &answers), 5.5);
    near(score("agency", "negative", &answers), 15.0 / 7.0);
}

#[test]
fn a_score_without_all_its_answers_is_missing() {
    let mut answers = answered("nasa-tlx", &[70.0, 20.0, 60.0, 35.0, 65.0, 50.0]);
    answers["effort"] = Value::Null;
    assert_eq!(score("nasa-tlx", "overall", &answers), None);
    assert_eq!(score("nasa-tlx", "effort", &answers), None);
    near(score("nasa-tlx", "frustration", &answers), 50.0);
    answers["effort"] = json!(51);
    assert_eq!(score("nasa-tlx", "overall", &answers), None, "51 is no point of the scale");
    assert!(scores("trust", &json!({})).iter().all(|(_, score)| score.is_none()));
}

#[test]
fn every_built_in_questionnaire_says_where_it_is_from_and_on_which_terms() {
    for known in built_in() {
        assert!(known.source.is_some() && known.terms.is_some(), "{}", known.name);
        for item in &known.items {
            for words in [&known.title, &known.intro, &item.text] {
                assert!(words.speaks("en") && words.speaks("de"), "{}: {}", known.name, item.id);
            }
        }
        assert!(
            known.scales().all(|(item, _)| item.required),
            "{}: a scale left out is no score",
            known.name
        );
        assert!(!known.scores().is_empty(), "{}", known.name);
    }
}

#[test]
fn a_studys_own_questionnaire_is_scored_in_the_same_way() {
    let own: Questionnaire = toml::from_str(
        r#"
        name = "own"
        title = "Own"
        each-item = true
        items = [
            { id = "a", kind = "scale", text = "A", least = 1, most = 5 },
            { id = "b", kind = "scale", text = "B", least = 1, most = 5, reversed = true },
            { id = "why", kind = "text", text = "Why?" },
        ]"#,
    )
    .expect("it is well-formed");
    let found = own.score(&json!({ "a": 4, "b": 1, "why": "so" }));
    let expected = [("a", 4.0), ("b", 5.0), ("overall", 4.5)];
    assert_eq!(found, expected.map(|(name, value)| (name.to_owned(), Some(value))));
}

/// Items, ends of scales and choices are shown as they are written: only introductions know markup.
#[test]
fn nobody_reads_asterisks() {
    for known in built_in() {
        let of_items = known.items.iter().flat_map(|item| {
            let more: Vec<&Words> = match &item.answer {
                AnswerKind::Scale(scale) => {
                    [&scale.left, &scale.right].into_iter().chain(&scale.labels).collect()
                }
                AnswerKind::Choice(choices) | AnswerKind::Many(choices) => {
                    choices.iter().map(|choice| &choice.text).collect()
                }
                AnswerKind::Number { unit, .. } => unit.iter().collect(),
                AnswerKind::Text { .. } => vec![],
            };
            more.into_iter().chain([&item.text])
        });
        for text in of_items.chain([&known.title, &known.intro]).flat_map(Words::all) {
            assert!(!text.contains("**"), "{}: {text}", known.name);
        }
    }
}
