//! A report of invented numbers: what stands where, and what becomes of data that allow nothing.

#[path = "../examples/study/invented.rs"]
mod invented;

use cohelm_study::analysis::{Analysis, Options};
use cohelm_study::dataset::{Dataset, LeftOut};
use cohelm_study::report::study_report;
use cohelm_study::statistics::bootstrap;

fn options() -> Options {
    Options { bootstrap: bootstrap::Options { resamples: 200, ..bootstrap::Options::default() } }
}

fn markdown(dataset: &Dataset) -> String {
    study_report(dataset, &options()).markdown()
}

#[test]
fn the_primary_outcome_stands_first_and_apart_from_the_exploratory_ones() {
    let dataset = invented::dataset().unwrap();
    let text = markdown(&dataset);
    let place = |heading: &str| text.find(heading).unwrap_or_else(|| panic!("{heading} is missing"));
    let order = [
        "## Primary outcome",
        "## Participants",
        "## Design",
        "## Exploratory outcomes",
        "## Questionnaires",
        "## Authority over the flight",
        "## Calibration of the confidence",
        "## Learning and order",
        "## How it was computed",
    ];
    assert!(order.windows(2).all(|two| place(two[0]) < place(two[1])));
    assert!(text.contains("Declared in advance: “Participants land at their own flag more often"));
    let analysis = Analysis::of(&dataset, options());
    assert_eq!(analysis.primary.unwrap().names(), ["lasc", "misc"]);
    let explored = analysis.exploratory.iter().find(|outcome| outcome.quantity.key == "success").unwrap();
    assert_eq!(explored.names(), ["hic", "lasc", "misc"], "declared for two modes, explored over all");
}

#[test]
fn everyone_is_accounted_for() {
    let dataset = invented::dataset().unwrap();
    let text = markdown(&dataset);
    assert!(text.contains("Invited: 29 (not further: 1 declined)"));
    assert!(text.contains("Analysed: 24"));
    let total = dataset.analysed().len() + (0..29).filter(|&i| dataset.left_out(i).is_some()).count();
    assert_eq!(total, dataset.participants.len());
    assert_eq!(dataset.left_out(24), Some(LeftOut::Excluded));
    assert!(text.contains("| How old are you? | 24 | mean "), "{text}");
    assert!(text.contains("| How often do you play computer games? | 24 | never "));
    assert!(!text.contains("simulated participant"), "people are not called simulated");
}

#[test]
fn simulated_participants_are_called_so_loudly_and_left_out_beside_people() {
    let mut dataset = invented::dataset().unwrap();
    dataset.participants[3].simulated = true;
    assert_eq!(dataset.left_out(3), Some(LeftOut::Simulated));
    assert!(markdown(&dataset).contains("Not counted here and in no analysis: 1 simulated participant"));
    invented::simulate(&mut dataset);
    let text = markdown(&dataset);
    let (banner, first) = (text.find("every participant is simulated"), text.find("## Primary outcome"));
    assert!(banner.unwrap() < first.unwrap());
    assert!(text.contains("24 simulated participants flew 3 modes"));
    assert!(text.contains("simulated participants have no opinions, and none was invented for them"));
}

#[test]
fn data_that_allow_no_test_get_sentences_and_no_nan() {
    for count in [0, 1, 2, 3] {
        let mut dataset = invented::dataset().unwrap();
        invented::leave(&mut dataset, count);
        let text = markdown(&dataset);
        for bad in ["NaN", "inf", "null"] {
            let found = text.split(|c: char| !c.is_alphanumeric()).any(|word| word == bad);
            assert!(!found, "{count} participants: {bad}");
        }
        if count == 0 {
            assert!(text.contains("Nobody has completed it yet"), "{text}");
        }
        if count == 1 {
            assert!(text.contains("a paired t test needs at least 2 participants, and there is 1"));
        }
    }
}

#[test]
fn a_mode_that_nobody_flew_and_a_measure_that_does_not_vary_get_their_reason() {
    let mut dataset = invented::dataset().unwrap();
    dataset.trials.retain(|trial| trial.condition != 1);
    assert!(markdown(&dataset).contains("Not in these tests, since a value is missing"));
    let mut same = invented::dataset().unwrap();
    for trial in &mut same.trials {
        trial.measured.as_mut().unwrap().values.insert("success", 1.0);
    }
    assert!(markdown(&same).contains("both conditions have the same value in every participant"));
}

#[test]
fn a_primary_measure_that_does_not_exist_is_said_so() {
    let mut dataset = invented::dataset().unwrap();
    dataset.design.primary.measure = "joy/overall".into();
    let text = markdown(&dataset);
    assert!(text.contains("there is no measure \"joy/overall\""), "{text}");
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let files = || study_report(&invented::dataset().unwrap(), &options()).files("report");
    assert!(files() == files());
}

#[test]
fn human_alone_is_in_no_test_of_interventions() {
    let dataset = invented::dataset().unwrap();
    let analysis = Analysis::of(&dataset, options());
    assert_eq!(analysis.outcome("interventions").unwrap().names(), ["lasc", "misc"]);
    assert_eq!(analysis.outcome("crash").unwrap().names(), ["hic", "lasc", "misc"]);
}
