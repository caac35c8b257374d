//! What must hold of the statistics for any table: a finite number or a reason, never NaN; the symmetries of each test.

use cohelm_study::statistics::bootstrap::{Options, mean_difference};
use cohelm_study::statistics::{
    Paired, Table, describe, effect_sizes, friedman, holm, one_way, paired_t, repeated_measures, tost,
    wilcoxon,
};
use proptest::prelude::*;

/// Values as studies have them: rates in fortieths, counts, and anything else; ties and constants are common.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => (0..=40_u32).prop_map(|landed| f64::from(landed) / 40.0),
        2 => (0..4_u32).prop_map(f64::from),
        1 => -1e6..1e6_f64,
        1 => prop_oneof![Just(1e100), Just(-1e100), Just(1e-300), Just(0.1 + 0.2)],
    ]
}

fn rows(columns: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Vec<f64>>> {
    columns.prop_flat_map(|k| prop::collection::vec(prop::collection::vec(value(), k), 0..12))
}

fn table(rows: &[Vec<f64>]) -> Table {
    let names = |count: usize| (0..count).map(|i| i.to_string()).collect();
    Table::complete(names(rows.len()), names(rows.first().map_or(0, Vec::len)), rows.to_vec()).unwrap()
}

/// Every number that a result prints, found by walking it as JSON: `null` would be a NaN or an infinity.
fn assert_finite(result: impl serde::Serialize + std::fmt::Debug) {
    fn no_null(value: &serde_json::Value) -> bool {
        match value {
            serde_json::Value::Null => false,
            serde_json::Value::Array(items) => items.iter().all(no_null),
            serde_json::Value::Object(fields) => fields.iter().all(|(name, field)| match name.as_str() {
                "sphericity" | "sd" | "mean_ci95" | "d_z" => field.is_null() || no_null(field),
                _ => no_null(field),
            }),
            _ => true,
        }
    }
    let json = serde_json::to_value(&result).unwrap();
    assert!(no_null(&json), "{result:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_number_or_a_reason(rows in rows(0..5), bound in 1e-3..10.0_f64) {
        let table = table(&rows);
        assert_finite(one_way(&table));
        assert_finite(repeated_measures(&table));
        assert_finite(friedman(&table));
        for column in table.columns() {
            assert_finite(describe(&column));
        }
        if let Ok(pair) = table.pair(0, 1) {
            assert_finite(paired_t(&pair));
            assert_finite(wilcoxon(&pair));
            assert_finite(effect_sizes(&pair));
            assert_finite(tost(&pair, bound));
            assert_finite(mean_difference(&pair, Options { resamples: 50, ..Options::default() }));
        }
    }

    #[test]
    fn swapping_the_conditions_turns_the_sign_and_keeps_p(rows in rows(2..3)) {
        let table = table(&rows);
        let (there, back) = (table.pair(0, 1), table.pair(1, 0));
        if let (Ok(there), Ok(back)) = (there, back) {
            prop_assert_eq!(paired_t(&there).map(|t| (t.t, t.p)), paired_t(&back).map(|t| (-t.t, t.p)));
            prop_assert_eq!(wilcoxon(&there).map(|w| (w.w, w.p)), wilcoxon(&back).map(|w| (w.w, w.p)));
            prop_assert_eq!(tost(&there, 0.5).map(|t| t.p), tost(&back, 0.5).map(|t| t.p));
        }
    }

    #[test]
    fn p_values_are_probabilities(rows in rows(3..5)) {
        let table = table(&rows);
        let mut p_values = vec![one_way(&table).map(|r| r.p), friedman(&table).map(|r| r.p)];
        if let Ok(rm) = repeated_measures(&table) {
            let s = rm.sphericity.unwrap();
            let lowest = 1.0 / (table.conditions().len() - 1) as f64;
            prop_assert!(s.epsilon >= lowest * (1.0 - 1e-9) && s.epsilon <= 1.0, "{}", s.epsilon);
            p_values.extend([Ok(rm.p), Ok(s.p_corrected)]);
            p_values.extend(s.mauchly.map(|m| Ok(m.p)));
        }
        for p in p_values.into_iter().flatten() {
            prop_assert!((0.0..=1.0).contains(&p), "{p}");
        }
    }

    #[test]
    fn holm_keeps_the_order_and_never_lowers(p_values in prop::collection::vec(prop::option::of(0.0..=1.0_f64), 0..8)) {
        let adjusted = holm(&p_values);
        for (i, before) in p_values.iter().enumerate() {
            prop_assert_eq!(before.is_some(), adjusted[i].is_some());
            prop_assert!(adjusted[i] >= *before && adjusted[i].unwrap_or(1.0) <= 1.0);
            for (j, other) in p_values.iter().enumerate() {
                prop_assert!(before > other || adjusted[i] <= adjusted[j] || other.is_none());
            }
        }
    }

    #[test]
    fn the_interval_of_a_mean_difference_moves_with_it(values in prop::collection::vec(0.0..1.0_f64, 3..9)) {
        let shifted: Vec<f64> = values.iter().map(|v| v + 4.0).collect();
        let flipped: Vec<f64> = values.iter().map(|v| 1.0 - v).collect();
        let options = Options { resamples: 100, ..Options::default() };
        let near = mean_difference(&Paired::new(&values, &flipped).unwrap(), options).unwrap();
        let far = mean_difference(&Paired::new(&shifted, &flipped).unwrap(), options).unwrap();
        prop_assert!((far.estimate - near.estimate - 4.0).abs() < 1e-9);
        prop_assert!(near.interval.low <= near.interval.high);
    }
}
