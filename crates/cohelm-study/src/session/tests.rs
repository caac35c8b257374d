//! A log folds to a session: every prefix, always to the same, and only what can happen.

mod walk;

use super::*;
use crate::design::schedule::assign;
use proptest::prelude::*;
use serde_json::json;
use walk::{Walk, pilot};

fn consented(simulated: bool) -> Walk {
    let mut walk = Walk::invited(simulated);
    walk.answer("consent", json!({ "agreed": true })).expect("consent is taken");
    walk.assign(1);
    walk
}

fn at_the_quiz() -> Walk {
    let mut walk = consented(false);
    walk.answer("device", json!({ "ok": true })).expect("taken");
    walk.answer("demographics", json!({ "age": 30 })).expect("taken");
    walk.answer("instructions", json!({})).expect("taken");
    walk
}

#[test]
fn a_session_goes_from_consent_to_thanks() {
    let mut walk = consented(true);
    walk.finish();
    let session = &walk.session;
    assert_eq!(session.status(), Status::Completed);
    assert_eq!(session.current().map(|step| step.id.as_str()), Some("thanks"));
    let code = session.code().expect("completed");
    assert!(code.len() == 8 && code.bytes().all(|byte| byte.is_ascii_alphanumeric()), "{code}");
    assert!(!session.counts(), "bots are in no analysis");
    assert_eq!(session.minutes_left(&walk.design).ceil(), 1.0);
}

#[test]
fn the_ids_of_steps_are_for_ever() {
    let walk = consented(false);
    let ids: Vec<&str> = walk.session.steps().iter().map(|step| step.id.as_str()).collect();
    let block = |block: usize| {
        let flights = (1..=2).map(move |n| format!("block-{block}/practice-{n}"));
        let flights = flights.chain((1..=6).map(move |n| format!("block-{block}/flight-{n}")));
        [format!("block-{block}")]
            .into_iter()
            .chain(flights)
            .chain([format!("block-{block}/questionnaire/paper-survey")])
    };
    let before = ["consent", "device", "demographics", "instructions", "quiz"].map(str::to_owned);
    let expected: Vec<String> = before
        .into_iter()
        .chain(block(1))
        .chain(["block-1/break".to_owned()])
        .chain(block(2))
        .chain(["block-2/break".to_owned()])
        .chain(block(3))
        .chain(["end/questionnaire/remarks", "debrief", "thanks"].map(str::to_owned))
        .collect();
    assert_eq!(ids, expected);
}

#[test]
fn nothing_is_answered_before_consent_and_nothing_out_of_turn() {
    let mut walk = Walk::invited(false);
    assert!(matches!(walk.answer("device", json!({})), Err(AnswerError::NotCurrent { .. })));
    assert!(matches!(walk.answer("nonsense", json!({})), Err(AnswerError::Unknown { .. })));
    assert!(matches!(walk.answer("consent", json!({})), Err(AnswerError::Items { .. })));
    let mut walk = consented(false);
    assert!(matches!(walk.answer("quiz", json!({})), Err(AnswerError::NotCurrent { .. })));
    assert_eq!(walk.answer("consent", json!({ "agreed": false })), Ok(()), "it was given already");
    assert_eq!(walk.session.status(), Status::UnderWay);
}

#[test]
fn who_declines_is_asked_nothing_more() {
    let mut walk = Walk::invited(false);
    walk.answer("consent", json!({ "agreed": false })).expect("one may decline");
    assert_eq!(walk.session.status(), Status::Declined);
    assert!(walk.session.current().is_none());
    assert_eq!(
        walk.answer("consent", json!({ "agreed": true })),
        Err(AnswerError::Over { status: Status::Declined })
    );
}

#[test]
fn answers_are_held_to_their_items() {
    let mut walk = consented(false);
    walk.answer("device", json!({ "ok": true })).expect("taken");
    let mut said = |data| walk.answer("demographics", data).expect_err("must be refused").items();
    assert_eq!(said(json!({ "age": 17 }))["age"], AnswerProblem::OutOfRange);
    assert_eq!(said(json!({ "age": "thirty" }))["age"], AnswerProblem::WrongKind);
    assert_eq!(said(json!({ "games": "often" }))["games"], AnswerProblem::NoChoice);
    assert_eq!(said(json!({ "name": "Eve" }))["name"], AnswerProblem::NoItem);
    walk.answer("demographics", json!({ "games": "daily" })).expect("the age may be left out");
    let data = &walk.session.done("demographics").expect("done").data;
    assert_eq!(*data, json!({ "age": null, "games": "daily" }), "what was not answered says so");
}

#[test]
fn a_required_scale_is_left_out_by_nobody_but_a_program() {
    for simulated in [false, true] {
        let mut walk = consented(simulated);
        walk.up_to("block-1/questionnaire/paper-survey");
        let answered = walk.answer("block-1/questionnaire/paper-survey", json!({ "helpful": 5 }));
        if simulated {
            answered.expect("a program answers nothing");
        } else {
            let items = answered.expect_err("four are missing").items();
            assert_eq!(items.len(), 4);
            assert!(items.values().all(|problem| *problem == AnswerProblem::Missing));
        }
    }
}

#[test]
fn a_quiz_is_asked_again_until_its_attempts_are_used_up() {
    let mut walk = at_the_quiz();
    let wrong = json!({ "goal": "nearest", "landed": "rests" });
    assert!(matches!(walk.answer("quiz", json!({ "goal": "nearest" })), Err(AnswerError::Items { .. })));
    walk.answer("quiz", wrong.clone()).expect("taken");
    assert_eq!(
        walk.log.last().map(|logged| &logged.event),
        Some(&Event::QuizMissed { wrong: vec!["goal".into()] })
    );
    walk.answer("quiz", wrong.clone()).expect("taken");
    assert_eq!(walk.session.current().map(|step| step.id.as_str()), Some("quiz"));
    walk.answer("quiz", wrong).expect("taken");
    assert_eq!(
        walk.session.current().map(|step| step.id.as_str()),
        Some("block-1"),
        "after three one goes on"
    );
    assert_eq!(walk.session.quiz_missed(), 3);
}

#[test]
fn a_quiz_may_end_the_study() {
    let mut walk = at_the_quiz();
    walk.design.quiz.as_mut().expect("there is one").failed = crate::design::OnFailedQuiz::Exclude;
    for _ in 0..3 {
        walk.answer("quiz", json!({ "goal": "nearest", "landed": "rests" })).expect("taken");
    }
    assert_eq!(walk.session.status(), Status::Excluded);
    assert_eq!(walk.session.excluded().expect("excluded").1, "design");
    assert!(walk.session.current().is_none());
    walk.append(Event::Reinstated { by: "desk".into() });
    assert_eq!(walk.session.current().map(|step| step.id.as_str()), Some("quiz"));
}

#[test]
fn a_flight_is_done_when_it_ended_and_its_telemetry_is_there() {
    let mut walk = consented(false);
    walk.up_to("block-1/practice-1");
    let step = "block-1/practice-1";
    assert_eq!(walk.answer(step, json!({})), Err(AnswerError::NotFlown { step: step.into() }));
    let key = walk.session.current_key().expect("it may be flown");
    walk.fly(Ending::Crash);
    assert_eq!(walk.session.current().map(|step| step.id.as_str()), Some(step), "its telemetry is missing");
    assert_eq!(walk.session.current_key(), None, "it is not flown twice");
    assert_eq!(walk.session.step_of_key(&key).map(|step| step.id.as_str()), Some(step));
    walk.answer(step, json!({ "late_ticks": 3, "hidden_ms": 12.5, "presses": "many" })).expect("taken");
    assert_eq!(walk.session.current().map(|step| step.id.as_str()), Some("block-1/practice-2"));
    let telemetry = walk.session.flight(step).expect("flown").telemetry.clone().expect("noted");
    assert_eq!((telemetry.late_ticks, telemetry.hidden_ms, telemetry.presses), (Some(3), Some(12.5), None));
    assert_eq!(
        walk.session.step_of_key(&key).map(|step| step.id.as_str()),
        Some(step),
        "a page that comes back finds it"
    );
}

#[test]
fn a_refused_flight_is_flown_again_under_another_key() {
    let mut walk = consented(false);
    walk.up_to("block-1/practice-1");
    let first = walk.session.current_key().expect("it may be flown");
    walk.begin();
    walk.append(Event::FlightRefused {
        step: "block-1/practice-1".into(),
        attempt: 1,
        episode: 7,
        reason: "tick 12 differs".into(),
    });
    assert_eq!(walk.session.attempt("block-1/practice-1"), 2);
    let second = walk.session.current_key().expect("it may be flown again");
    assert_ne!(first, second);
    assert_eq!(walk.session.step_of_key(&first), None);
}

#[test]
fn the_page_sees_what_remains_in_the_participants_language_and_no_answers_or_rules() {
    let mut walk = consented(false);
    walk.append(Event::LanguageChosen { language: "de".into() });
    let shown = walk.shown();
    assert_eq!(shown.len(), walk.session.steps().len() - 1);
    assert_eq!(shown[0].id, "device");
    let text = serde_json::to_string(&shown).expect("steps are JSON");
    for german in ["Modus A", "Wie alt sind Sie?", "Vielen Dank"] {
        assert!(text.contains(german), "{german}");
    }
    let quiz = shown.iter().find(|step| step.id == "quiz").expect("it is to come");
    assert!(!serde_json::to_string(quiz).expect("JSON").contains("right"), "right answers stay here");
    let back: Vec<ShownStep> = serde_json::from_str(&text).expect("what is written can be read");
    assert_eq!(back, shown);
    let before = Walk::invited(false);
    let ids: Vec<String> = before.shown().into_iter().map(|step| step.id).collect();
    assert_eq!(ids, ["consent"], "before consent the order is not settled");
}

/// The examples of the interface: tags and fields as the page expects them.
#[test]
fn shown_steps_have_the_form_of_the_interface() {
    let walk = consented(false);
    let shown = |id: &str| {
        let steps = walk.shown();
        serde_json::to_value(steps.iter().find(|step| step.id == id).expect("to come")).expect("JSON")
    };
    let item = &shown("block-1/questionnaire/paper-survey")["items"][0];
    assert_eq!((&item["kind"], &item["least"], &item["most"]), (&json!("scale"), &json!(0.0), &json!(10.0)));
    assert_eq!((&item["start"], &item["left"]), (&Value::Null, &json!("strongly disagree")));
    assert_eq!(
        shown("block-1/break"),
        json!({
            "id": "block-1/break", "kind": "break", "at_least_s": 0, "at_most_s": 120,
            "text": walk.design.breaks.text.read("en", "en"),
        })
    );
    let flight = shown("block-2/flight-3");
    assert_eq!(flight["kind"], "flight");
    assert_eq!((&flight["number"], &flight["of"], &flight["block"]), (&json!(3), &json!(6), &json!(2)));
    assert_eq!(
        (&flight["label"], &flight["practice"], &flight["feedback"]),
        (&json!("Mode B"), &json!(false), &json!(false))
    );
    assert_eq!(flight["setup"]["pilot"], "person");
    assert_eq!(flight["flight_key"].as_str().map(str::len), Some(32));
    assert_eq!(
        (&flight["attempt"], &flight["flown"], &flight["committed_ticks"]),
        (&json!(1), &Value::Null, &json!(0))
    );
    assert_eq!(shown("block-1")["practice"], 2);
    assert_eq!(shown("quiz")["attempts"], 3);
    assert_eq!(shown("demographics")["kind"], "form");
}

#[test]
fn a_log_is_json_with_tags_of_its_own() {
    let line = r#"{"seq":3,"at_ms":5,"event":"flight-ended","step":"block-1/flight-1","attempt":1,"episode":9,"ending":"out-of-bounds","ticks":80}"#;
    let logged: Logged = serde_json::from_str(line).expect("well-formed");
    let Event::FlightEnded { ending, ticks, .. } = &logged.event else { panic!("{logged:?}") };
    assert_eq!((*ending, *ticks), (Ending::OutOfBounds, 80));
    assert_eq!(serde_json::to_string(&logged).expect("JSON"), line);
}

/// The words of the documentation are those of the log.
#[test]
fn every_event_is_documented() {
    let docs = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/study.md"))
        .expect("shipped");
    let text = docs
        .split("## The log of a session")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next())
        .expect("a section");
    let mut walk = consented(false);
    walk.up_to("block-1/practice-1");
    (64..68).for_each(|choice| walk.wander(choice));
    (0..=255).for_each(|choice| walk.wander(choice));
    walk.append(Event::QuizMissed { wrong: vec![] });
    walk.append(Event::TakenOver { tab: "b".into() });
    walk.append(Event::Withdrawn { by: "desk".into() });
    let mut declined = Walk::invited(false);
    declined.answer("consent", json!({ "agreed": false })).expect("one may");
    let completed = Event::Completed { code: "X".into() };
    let logged = walk.log.iter().chain(&declined.log).map(|logged| &logged.event).chain([&completed]);
    let words: std::collections::BTreeSet<&str> = logged.map(Event::word).collect();
    assert_eq!(words.len(), 19, "one of each: {words:?}");
    for word in words {
        assert!(text.contains(&format!("`{word}`")), "{word}");
        let example = text.lines().find(|line| line.starts_with("{\"seq\"")).expect("there is an example");
        serde_json::from_str::<Logged>(example).expect("the example is an event");
    }
}

#[test]
fn what_cannot_have_happened_does_not_fold() {
    let walk = consented(false);
    let refused = |event: Event| {
        let seq = walk.session.next_seq();
        walk.session
            .clone()
            .push(&walk.design, &Logged { seq, at_ms: 0, event })
            .expect_err("must be refused")
    };
    let begun =
        |step: &str| Event::FlightBegun { step: step.into(), attempt: 1, episode: 1, clock_offset_ms: None };
    assert!(matches!(refused(begun("block-1/flight-1")), FoldError::OutOfPlace { .. }));
    assert!(matches!(refused(Event::Completed { code: "X".into() }), FoldError::OutOfPlace { .. }));
    let done = Event::StepDone { step: "thanks".into(), data: json!({}), page_ms: None };
    assert!(matches!(refused(done), FoldError::OutOfPlace { .. }));
    let again = Event::Assigned { cell: 0, order: vec![0, 1, 2], seed: 0, design: walk.design.hash() };
    assert!(matches!(refused(again), FoldError::OutOfPlace { .. }));
    assert_eq!(Session::fold(&walk.design, &[]), Err(FoldError::Empty));
    assert!(matches!(
        Session::fold(&walk.design, &walk.log[1..]),
        Err(FoldError::Gap { expected: 1, got: 2 })
    ));
    let gap = [walk.log[0].clone(), walk.log[2].clone()];
    assert!(matches!(Session::fold(&walk.design, &gap), Err(FoldError::Gap { expected: 2, got: 3 })));
}

#[test]
fn a_session_keeps_to_the_design_it_began_with() {
    let walk = consented(false);
    let text = walk.design.text.replace("planned-participants = 6", "planned-participants = 12");
    let other = Design::from_toml(&text).expect("as good as the first");
    assert!(matches!(Session::fold(&other, &walk.log), Err(FoldError::OtherDesign { .. })));
}

#[test]
fn withdrawing_ends_everything() {
    let mut walk = consented(false);
    walk.append(Event::Withdrawn { by: "participant".into() });
    assert_eq!(walk.session.status(), Status::Withdrawn);
    assert_eq!(walk.answer("device", json!({})), Err(AnswerError::Over { status: Status::Withdrawn }));
    assert_eq!(walk.shown(), []);
}

#[test]
fn the_panels_address_is_filled_in_and_encoded() {
    let text = pilot().text
        + "\n[panel]\nparameters = [\"PID\"]\nparticipant = \"PID\"\n\
        completed = \"https://panel.example/done?cc={code}&p={PID}\"\n";
    let mut walk = Walk::of(Design::from_toml(&text).expect("well-formed"), true, &[("PID", "a&b/ü")]);
    walk.answer("consent", json!({ "agreed": true })).expect("taken");
    walk.assign(3);
    assert_eq!(walk.session.return_address(&walk.design), None, "not yet");
    walk.finish();
    let code = walk.session.code().expect("completed").to_owned();
    let expected = format!("https://panel.example/done?cc={code}&p=a%26b%2F%C3%BC");
    assert_eq!(walk.session.return_address(&walk.design), Some(expected));
}

#[test]
fn rules_of_exclusion_see_what_they_are_about() {
    let mut walk = consented(false);
    walk.design.exclusion.late_ticks_over = Some(0.1);
    walk.design.exclusion.silent_flights_over = Some(0.5);
    walk.design.exclusion.interrupted_flights_over = Some(0);
    walk.up_to("block-1/flight-1");
    assert_eq!(walk.session.breaches(&walk.design), [], "practice counts for nothing");
    walk.begin();
    let (step, attempt) = ("block-1/flight-1".to_owned(), 1);
    walk.append(Event::FlightInterrupted { step, attempt, tick: 5, reason: "reload".into() });
    walk.end(Ending::Goal, 100);
    walk.answer("block-1/flight-1", json!({ "late_ticks": 25, "presses": 0 })).expect("taken");
    let rules: Vec<_> =
        walk.session.breaches(&walk.design).into_iter().map(|breach| (breach.rule, breach.found)).collect();
    let expected =
        [("late-ticks-over", 0.25), ("interrupted-flights-over", 1.0), ("silent-flights-over", 1.0)];
    assert_eq!(rules, expected);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Whatever happens on the way: the log as JSON folds to the same session, every prefix folds, a place is never lost,
    /// and every answer may come twice.
    #[test]
    fn any_way_through_folds_at_every_point(choices in prop::collection::vec(any::<u8>(), 1..400), simulated: bool) {
        let mut walk = Walk::invited(simulated);
        for choice in choices {
            walk.wander(choice);
        }
        let json = serde_json::to_string(&walk.log).unwrap();
        let log: Vec<Logged> = serde_json::from_str(&json).unwrap();
        prop_assert_eq!(&log, &walk.log);
        let folded = Session::fold(&walk.design, &log).unwrap();
        prop_assert_eq!(&folded, &walk.session, "a fold is the same as one event after the other");
        let mut place = 0;
        for length in 1..=log.len() {
            let prefix = Session::fold(&walk.design, &log[..length]).unwrap();
            prop_assert!(prefix.place() >= place, "a place is never lost");
            place = prefix.place();
            prop_assert!(prefix.shown(&walk.design, &walk.resolved).is_ok());
        }
        for step in folded.steps()[..folded.place()].iter() {
            prop_assert_eq!(folded.accept(&walk.design, &step.id, &json!({})), Ok(vec![]), "done is done");
        }
    }

    /// Keys are all different, so that no flight is taken for another.
    #[test]
    fn no_two_flights_share_a_key(entropy: u64, other: u64) {
        let design = pilot();
        let mut keys = std::collections::BTreeSet::new();
        let mut count = 0;
        for entropy in [entropy, other] {
            let given = assign(&design, &[], entropy);
            for step in timeline::steps(&design, &given).iter().filter(|step| step.flight().is_some()) {
                for attempt in 1..3 {
                    keys.insert(timeline::flight_key(&given, step, attempt));
                    count += 1;
                }
            }
        }
        let seed_bits = (1u64 << 53) - 1;
        prop_assume!(entropy & seed_bits != other & seed_bits);
        prop_assert_eq!(keys.len(), count);
    }
}
