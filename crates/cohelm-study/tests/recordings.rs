//! Our statistics against recordings of pingouin and SciPy, and hostile files against the reader.
//!
//! Recipes beside the recordings: `record_statistics.py` made `statistics.json` (seed 1, 12 cases), and
//! `record_other_shapes.py other_KIND.json 1 6 KIND` the others.

use cohelm_study::verify::{Report, VerifyError, statistics};
use proptest::prelude::*;

const STATISTICS: &str = include_str!("data/statistics.json");

fn assert_all_within(recording: &str, cases: usize, at_least: usize) -> Report {
    let report = statistics(recording.as_bytes()).unwrap();
    assert!(report.all_within() && report.unknown.is_empty(), "{report}");
    assert!(report.cases == cases && report.values >= at_least, "{report}");
    report
}

fn problem(recording: &str) -> String {
    statistics(recording.as_bytes()).unwrap_err().to_string()
}

#[test]
fn the_project_s_recording() {
    assert_all_within(STATISTICS, 12, 600);
}

#[test]
fn other_shapes_and_few_participants() {
    assert_all_within(include_str!("data/other_shapes.json"), 6, 350);
    assert_all_within(include_str!("data/other_small.json"), 6, 240);
}

#[test]
fn ties_zeros_and_rates() {
    assert_all_within(include_str!("data/other_ties.json"), 6, 340);
    assert_all_within(include_str!("data/other_rates.json"), 6, 300);
}

#[test]
fn constant_and_equal_columns() {
    let report = assert_all_within(include_str!("data/other_degenerate.json"), 6, 350);
    assert!(report.undefined_in_recording > 0, "{report}");
}

#[test]
fn a_changed_number_is_found_and_named() {
    let changed = STATISTICS.replacen("0.4114457237883667", "0.4114462237883667", 1);
    let report = statistics(changed.as_bytes()).unwrap();
    assert_eq!(report.values - report.within, 1);
    let first = report.first_difference.as_ref().unwrap();
    assert_eq!((first.case, first.name.as_str()), (0, "one_way.F"));
    assert!(
        report
            .to_string()
            .contains("first difference: case 0, one_way.F: recorded 0.4114462237883667, ours 0.411")
    );
}

#[test]
fn a_tiny_p_value_must_be_right_too() {
    let report = statistics(include_bytes!("data/other_shapes.json").as_slice()).unwrap();
    assert!(report.largest_relative < 1e-9, "{report}");
    let zeroed = STATISTICS.replacen("\"tost_p\": 0.5170676802308664", "\"tost_p\": 1e-30", 1);
    assert!(!statistics(zeroed.as_bytes()).unwrap().all_within());
}

#[test]
fn unknown_numbers_are_listed_and_missing_ones_refused() {
    let more = STATISTICS.replacen(
        "\"tost_bound\": 0.5",
        "\"tost_bound\": 0.5, \"new\": [{\"x\": 1.0}, {\"x\": 2.0}]",
        1,
    );
    assert_eq!(statistics(more.as_bytes()).unwrap().unknown, ["new.x"]);
    let fewer = STATISTICS.replacen("\"epsilon\"", "\"epsilon of old\"", 1);
    assert_eq!(problem(&fewer), "case 0: `rm.epsilon` is missing");
}

#[test]
fn files_that_are_no_recording_get_a_reason() {
    assert!(problem("").starts_with("the recording is not JSON: EOF"));
    assert!(problem("{\"cases\": 3}").contains("expected an object with a non-empty list `cases`"));
    assert!(problem("{\"cases\": []}").contains("non-empty"));
    assert_eq!(problem("{\"cases\": [{}]}"), "case 0: `table` is missing or no list of rows");
    assert_eq!(
        problem("{\"cases\": [{\"table\": [[1, \"2\"]]}]}"),
        "case 0: `table[0][1]` is no finite number"
    );
    assert_eq!(
        problem("{\"cases\": [{\"table\": [[1, NaN]]}]}"),
        "case 0: `table[0][1]` is no finite number"
    );
    assert_eq!(
        problem("{\"cases\": [{\"table\": [[1, 2], [1]]}]}"),
        "case 0: `table`: the row of \"row 1\" has 1 values where 2 conditions are named"
    );
    let far_pair =
        "{\"cases\": [{\"table\": [[1, 2], [2, 1]], \"tost_bound\": 1, \"pairs\": [{\"a\": 0, \"b\": 7}]}]}";
    assert_eq!(problem(far_pair), "case 0: pairs[0]: there is no condition \"number 7\" in the table");
    let wide = format!("{{\"cases\": [{{\"table\": [[{}1]]}}]}}", "1,".repeat(100));
    assert!(problem(&wide).contains("101 columns; at most 64"));
}

#[test]
fn an_unreadable_file_says_so() {
    struct Broken;
    impl std::io::Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("disk on fire"))
        }
    }
    assert!(matches!(statistics(Broken), Err(VerifyError::Read(_))));
}

proptest! {
    // Failures are printed with their input; files of them are not wanted in the tree.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = statistics(bytes.as_slice());
    }

    #[test]
    fn no_damage_to_a_recording_makes_it_panic(
        damage in prop::collection::vec((0..STATISTICS.len(), any::<u8>()), 1..8),
        kept in 0..=STATISTICS.len(),
    ) {
        let mut bytes = STATISTICS.as_bytes().to_vec();
        for (at, byte) in damage {
            bytes[at] = byte;
        }
        bytes.truncate(kept);
        let _ = statistics(bytes.as_slice());
    }

    #[test]
    fn no_table_makes_it_panic(
        rows in prop::collection::vec(prop::collection::vec(-1e300..1e300_f64, 0..5), 0..6),
        bound in -1.0..1.0_f64,
    ) {
        let pairs = serde_json::json!([{"a": 0, "b": 1}, {"a": 1, "b": 1}]);
        let case = serde_json::json!({"table": rows, "tost_bound": bound, "pairs": pairs});
        let _ = statistics(serde_json::json!({"cases": [case]}).to_string().as_bytes());
    }
}
