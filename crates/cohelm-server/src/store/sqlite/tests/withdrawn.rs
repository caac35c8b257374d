//! Of who withdrew, not a byte is left in the files.

use super::*;
use crate::store::{ParticipantId, TokenHash, Trial};
use crate::testing::{key, setup};

const ANNA: ParticipantId = ParticipantId(1);
/// What can be recognised: in the link's hash, in answers and in reasons.
const MARK: &[u8; 32] = b"MARKED MARKED MARKED MARKED MARK";

async fn anna(disk: &Disk) {
    let hash = "ab".repeat(32);
    let study = Write::Study { hash: hash.clone(), name: "s".into(), text: "t".into(), at_ms: 1 };
    let anna =
        Write::Participant { id: ANNA, study: hash, code: "A".into(), token: TokenHash(*MARK), at_ms: 1 };
    let trial = |step: &str| Trial { participant: ANNA, step: step.into() };
    let begin = |number, step| Write::BeginTrial {
        key: key(number),
        setup: setup(number.into()),
        at_ms: 1,
        trial: trial(step),
    };
    let made = disk.store.commit(&[study, anna, begin(1, "a"), begin(2, "b MARKED")]).await.unwrap();
    // Long enough to need pages of its own.
    let event = |seq, length: usize| Write::Event {
        participant: ANNA,
        expected_seq: seq,
        event_json: format!(r#""{}""#, "MARKED ".repeat(length)),
        at_ms: 1,
    };
    disk.store.commit(&[event(1, 1), event(2, 3_000)]).await.unwrap();
    let refuse = Write::Refuse { episode: made[2].unwrap(), reason: "it is MARKED".into(), at_ms: 1 };
    disk.store.commit(&[refuse]).await.unwrap();
}

fn withdraw() -> Write {
    Write::Withdraw { participant: ANNA, left: vec!["{}".into()], at_ms: 2 }
}

/// In which files of the folder the mark is.
fn marked(disk: &Disk) -> Vec<String> {
    let holds = |path: &PathBuf| fs::read(path).unwrap().windows(6).any(|bytes| bytes == b"MARKED");
    let files = fs::read_dir(disk.folder.path()).unwrap().map(|entry| entry.unwrap().path());
    files.filter(holds).map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect()
}

#[tokio::test]
async fn nothing_is_left_in_the_files_while_the_database_is_open() {
    let disk = Disk::new().await;
    anna(&disk).await;
    assert!(!marked(&disk).is_empty());
    disk.store.commit(&[withdraw()]).await.unwrap();
    assert_eq!(marked(&disk), [""; 0]);
}

#[tokio::test]
async fn a_reader_may_delay_it_until_the_next_commit() {
    let disk = Disk::new().await;
    anna(&disk).await;
    let mut reader = disk.store.driver.snapshot().await.unwrap();
    reader.read("SELECT COUNT(*) FROM events", &[]).await.unwrap();
    disk.store.commit(&[withdraw()]).await.unwrap();
    assert_eq!(disk.store.events(ANNA, 0).await.unwrap().len(), 1, "it is deleted all the same");
    assert!(!marked(&disk).is_empty(), "somebody reads the moment before");
    drop(reader);
    disk.store.commit(&[Write::Setting { name: "a".into(), value: "b".into() }]).await.unwrap();
    assert_eq!(marked(&disk), [""; 0]);
}

#[tokio::test]
async fn a_reader_may_delay_it_until_the_database_is_closed() {
    let disk = Disk::new().await;
    anna(&disk).await;
    let mut reader = disk.store.driver.snapshot().await.unwrap();
    reader.read("SELECT COUNT(*) FROM events", &[]).await.unwrap();
    disk.store.commit(&[withdraw()]).await.unwrap();
    drop(reader);
    disk.store.close().await;
    assert_eq!(marked(&disk), [""; 0]);
}
