//! One episode of each verdict.

use super::*;
use crate::store::{Record, Store, Write};
use crate::testing::{Disk, Page as PageOfTests, assisted, buttons::model, flown, key, setup};
use cohelm::trajectory::Setup;

async fn store(disk: &Disk, flown: &Trajectory) -> EpisodeId {
    let write = Write::Episode { record: Record::new(flown), at_ms: 0 };
    disk.store.commit(&[write]).await.unwrap()[0].unwrap()
}

/// The verdict about the only episode.
async fn verdict(flown: &Trajectory) -> Verdict {
    let disk = Disk::new().await;
    let id = store(&disk, flown).await;
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert_eq!(report.finished, 1);
    report
        .others
        .into_iter()
        .find(|(other, _)| *other == id)
        .map_or(Verdict::Identical, |(_, verdict)| verdict)
}

fn changed(change: impl FnOnce(&mut Trajectory)) -> Trajectory {
    let mut flown = flown(1);
    change(&mut flown);
    flown
}

#[tokio::test]
async fn what_was_flown_here_is_identical() {
    assert_eq!(verdict(&flown(1)).await, Verdict::Identical);
}

#[tokio::test]
async fn each_difference_is_named() {
    let different = |what: &str| Verdict::Different { what: what.into() };
    let keys = verdict(&changed(|flown| flown.keys[0].tick += 1)).await;
    assert_eq!(keys, different("the requests that the keys give"));
    let decisions = verdict(&changed(|flown| flown.digests.decisions += 1)).await;
    assert_eq!(decisions, different("the decisions"));
    let plant = verdict(&changed(|flown| flown.digests.plant += 1)).await;
    assert_eq!(plant, different("the plant's states, rewards or ending"));
}

#[tokio::test]
async fn another_version_of_the_plant_is_counted_apart_and_not_replayed() {
    let older = changed(|flown| {
        flown.setup.plant_version = 0;
        flown.digests.plant += 1;
    });
    assert!(
        matches!(verdict(&older).await, Verdict::OtherVersion { version } if version.contains("here it is 1"))
    );
    let unknown = changed(|flown| flown.setup.task.plant = "submarine".into());
    assert!(
        matches!(verdict(&unknown).await, Verdict::OtherVersion { version } if version.contains("submarine"))
    );
}

#[tokio::test]
async fn decisions_of_a_model_are_checked_and_a_missing_model_is_said() {
    let disk = Disk::new().await;
    let mut models = Models::new();
    let model = models.add_model(model(1)).clone();
    let at_ms = 0;
    let keep = Write::Model { model: model.clone(), origin: crate::store::Origin::Learned, at_ms };
    disk.store.commit(&[keep]).await.unwrap();
    let mut page = PageOfTests::with(assisted(1, &model), &models);
    page.fly(10_000);
    let id = store(&disk, &page.trajectory()).await;
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert_eq!((report.identical, report.others), (1, vec![]));

    disk.store.lose_models().await;
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert!(report.holds());
    assert!(
        matches!(&report.others[..], [(other, Verdict::ModelMissing { .. })] if *other == id),
        "{report}"
    );
}

#[tokio::test]
async fn a_list_that_says_otherwise_than_the_record_is_a_difference() {
    let disk = Disk::new().await;
    let begin = Write::Begin { key: key(1), setup: Setup { seed: 2, ..setup(1) }, at_ms: 0 };
    let episode = disk.store.commit(&[begin]).await.unwrap()[0].unwrap();
    let finish = Write::Finish { episode, record: Record::new(&flown(1)), at_ms: 0 };
    disk.store.commit(&[finish]).await.unwrap();
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert!(!report.holds() && report.to_string().contains("the list says otherwise"), "{report}");
}

#[tokio::test]
async fn the_report_counts_everything_and_is_the_same_each_time() {
    let disk = Disk::new().await;
    for seed in 1..=5 {
        store(&disk, &flown(seed)).await;
    }
    store(&disk, &changed(|flown| flown.digests.plant += 1)).await;
    let begin = |number| Write::Begin { key: key(number), setup: setup(number.into()), at_ms: 0 };
    let begun = disk.store.commit(&[begin(1), begin(2)]).await.unwrap();
    let refuse = Write::Refuse { episode: begun[0].unwrap(), reason: "other bits".into(), at_ms: 0 };
    disk.store.commit(&[refuse]).await.unwrap();
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert_eq!((report.finished, report.identical, report.in_the_air, report.refused), (6, 5, 1, 1));
    let text = "\
finished episodes             6
  identical                   5
  from recorded states        0
  different                   1
  of another version          0
  a model is missing          0
  unreadable                  0
in the air, interrupted       1
refused when flown            1
episode 6: different: the plant's states, rewards or ending
";
    assert_eq!(report.to_string(), text);
    assert_eq!(verify_episodes(&disk.hangar()).await.unwrap().to_string(), text);
}
