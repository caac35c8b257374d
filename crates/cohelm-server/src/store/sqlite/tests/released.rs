//! Databases that released versions wrote are brought up to date, and lose nothing.
//!
//! `tests/data/schema-1.db` was written by version 0.1.0 at the commit 8e346d4: five episodes (one helped by a model, one
//! finished from pieces, one in the air after two pieces, one refused after one piece, one forgotten), and a model that
//! somebody chose to keep. Its bytes are never changed.

use super::*;
use crate::hangar::Hangar;
use crate::store::{EpisodeId, Progress};
use crate::testing::{flown, key, plants};
use crate::verify::verify_episodes;
use cohelm_copilot::Models;
use std::sync::Arc;

const SCHEMA_1: &[u8] = include_bytes!("../../../../tests/data/schema-1.db");

#[tokio::test]
async fn a_database_of_schema_1_is_brought_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cohelm.db");
    fs::write(&path, SCHEMA_1).unwrap();
    let store = Arc::new(SqliteStore::open_existing(&path).await.unwrap());

    let rows = store.episodes(Page::newest(9)).await.unwrap();
    let ids: Vec<i64> = rows.iter().map(|row| row.id.0).collect();
    assert_eq!(ids, [4, 3, 2, 1]);
    assert!(rows.iter().all(|row| row.trial.is_none() && row.program == "0.1.0"));
    assert_eq!(rows[0].progress, Progress::Refused { reason: "other bits".into() });
    assert_eq!((rows[1].progress.clone(), rows[1].ticks), (Progress::InTheAir, 100));
    assert_eq!(store.flight(key(3)).await.unwrap().unwrap().id, EpisodeId(3));
    let pieces =
        [store.chunks(EpisodeId(3)).await.unwrap().len(), store.chunks(EpisodeId(4)).await.unwrap().len()];
    assert_eq!(pieces, [2, 1]);
    let model = &store.models().await.unwrap()[0];
    assert_eq!((model.origin.as_str(), model.kept_at_ms), ("learned", Some(1_790_000_000_001)));
    assert_eq!(rows[3].values.as_ref(), Some(&model.hash));

    let report = verify_episodes(&Hangar::new(plants(), Models::new(), store.clone())).await.unwrap();
    assert_eq!(
        (report.finished, report.in_the_air, report.refused, report.holds()),
        (2, 1, 1, true),
        "{report}"
    );
    // Studies can begin in it, and the number of the forgotten episode is not given again.
    assert_eq!(store.studies().await, Ok(vec![]));
    let next = store.commit(&[Write::Episode { record: record(1), at_ms: 0 }]).await.unwrap();
    assert_eq!(next, [Some(EpisodeId(6))]);
    store.close().await;

    let again = SqliteStore::open_existing(&path).await.unwrap();
    assert_eq!(again.episodes(Page::newest(9)).await.unwrap().len(), 5);
}

#[tokio::test]
async fn a_record_of_schema_1_is_the_flight_that_is_flown_today() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cohelm.db");
    fs::write(&path, SCHEMA_1).unwrap();
    let store = SqliteStore::open_existing(&path).await.unwrap();
    let bytes = crate::store::unpack(&store.record(EpisodeId(2)).await.unwrap().unwrap()).unwrap();
    assert_eq!(cohelm::trajectory::Trajectory::from_bytes(&bytes).unwrap(), flown(2));
}
