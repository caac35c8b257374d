//! A learner that gives a new model after each episode: what becomes of its models.

use super::*;
use crate::store::SqliteStore;
use crate::testing::{Disk, Page, assisted, buttons::model};
use cohelm_copilot::Models;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;
use tokio::time::timeout;

/// Gives model 1 after the first episode, model 2 after the second...; waits for the word before each.
struct Counting {
    learned: u32,
    word: Receiver<()>,
}

impl Learner for Counting {
    fn learn(&mut self, _flown: &Trajectory) -> Option<Vec<u8>> {
        self.word.recv().ok()?;
        self.learned += 1;
        (self.learned < 4).then(|| model(self.learned).bytes().to_vec())
    }

    fn return_to(&mut self, model: &Model) {
        assert_eq!(model.hash(), self::model(0).hash());
        self.learned = 0;
    }
}

struct Broken;

impl Learner for Broken {
    fn learn(&mut self, _flown: &Trajectory) -> Option<Vec<u8>> {
        Some(b"no model".to_vec())
    }

    fn return_to(&mut self, _model: &Model) {}
}

async fn started(store: &Arc<SqliteStore>, learner: impl Learner + 'static) -> Learning {
    let store: Arc<dyn Store> = store.clone();
    let lessons = Lessons { learner: Box::new(learner), current: model(0), shipped: model(0) };
    Learning::start(lessons, &store, Writer::start(store.clone())).await.unwrap()
}

fn counting() -> (Sender<()>, Counting) {
    let (say, word) = channel();
    (say, Counting { learned: 0, word })
}

fn episode() -> Trajectory {
    let mut models = Models::new();
    models.add_model(model(0));
    let mut page = Page::with(assisted(1, &model(0)), &models);
    page.fly(20);
    page.trajectory()
}

async fn next(news: &mut watch::Receiver<String>) -> String {
    timeout(Duration::from_secs(20), news.changed()).await.expect("there is news in time").unwrap();
    news.borrow_and_update().clone()
}

#[tokio::test]
async fn each_episode_brings_new_values_that_are_stored_and_announced() {
    let disk = Disk::new().await;
    let (say, learner) = counting();
    let learning = started(&disk.store, learner).await;
    let mut news = learning.news();
    for number in 1..=2 {
        learning.hand_in(episode());
        say.send(()).unwrap();
        assert_eq!(next(&mut news).await, model(number).hash());
        assert_eq!(learning.current(), model(number).hash());
        let stored = disk.store.model(model(number).hash()).await.unwrap().unwrap();
        assert_eq!(stored, model(number).bytes());
    }
    let origins: Vec<String> =
        disk.store.models().await.unwrap().into_iter().map(|model| model.origin).collect();
    assert_eq!(origins, ["shipped", "learned", "learned"]);
    assert_eq!(learning.status().learned, 2);
}

#[tokio::test]
async fn returning_makes_news_of_what_was_handed_in_before_worthless() {
    let disk = Disk::new().await;
    let (say, learner) = counting();
    let learning = started(&disk.store, learner).await;
    let mut news = learning.news();
    learning.hand_in(episode());
    say.send(()).unwrap();
    next(&mut news).await;
    learning.hand_in(episode());
    let status = learning.return_to_shipped().await.unwrap();
    assert_eq!((status.current, status.learned), (model(0).hash().into(), 0));
    assert_eq!(next(&mut news).await, model(0).hash());
    say.send(()).unwrap();
    say.send(()).unwrap();
    learning.hand_in(episode());
    // The learner began anew: after the episode that was under way, the next one gives the first model again.
    assert_eq!(next(&mut news).await, model(1).hash());
}

#[tokio::test]
async fn kept_values_are_remembered_until_the_shipped_ones_are_wanted_again() {
    let disk = Disk::new().await;
    let (say, learner) = counting();
    let learning = started(&disk.store, learner).await;
    let mut news = learning.news();
    learning.hand_in(episode());
    say.send(()).unwrap();
    next(&mut news).await;
    let hash = model(1).hash().to_owned();
    assert_eq!(learning.keep_current().await.unwrap().kept, Some(hash.clone()));
    assert_eq!(kept(disk.store.as_ref(), "buttons").await, Ok(Some(hash)));
    assert_eq!(kept(disk.store.as_ref(), "point").await, Ok(None));
    learning.return_to_shipped().await.unwrap();
    assert_eq!(kept(disk.store.as_ref(), "buttons").await, Ok(None));
}

#[tokio::test]
async fn what_is_no_model_is_said_and_the_values_stay() {
    let disk = Disk::new().await;
    let learning = started(&disk.store, Broken).await;
    learning.hand_in(episode());
    let failed = async {
        while learning.status().failure.is_none() {
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    };
    timeout(Duration::from_secs(20), failed).await.expect("it fails in time");
    assert_eq!(learning.current(), model(0).hash());
}

#[tokio::test]
async fn episodes_of_other_plants_teach_nothing_and_too_many_are_left_out() {
    let disk = Disk::new().await;
    let (say, learner) = counting();
    let learning = started(&disk.store, learner).await;
    learning.hand_in(crate::testing::flown(1));
    assert_eq!(learning.status().waiting, 0);
    for _ in 0..MOST_WAITING + 10 {
        learning.hand_in(episode());
    }
    let status = learning.status();
    assert!(status.left_out >= 9 && status.waiting as usize <= MOST_WAITING + 1, "{status:?}");
    drop(say);
}
