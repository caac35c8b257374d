//! Backups while others write, and what they must not overwrite.

use super::*;
use crate::hangar::Hangar;
use crate::store::{open, restore};
use crate::testing::plants;
use crate::verify::verify_episodes;
use cohelm_copilot::Models;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_backup_taken_while_others_write_opens_and_verifies() {
    let (disk, backups) = (Disk::new().await, tempfile::tempdir().unwrap());
    let (store, stop) = (disk.store.clone(), Arc::new(AtomicBool::new(false)));
    let stopped = stop.clone();
    let writing = tokio::spawn(async move {
        let mut committed = 0;
        while !stopped.load(Ordering::Relaxed) {
            // Two at a time: a backup with an odd number would have cut a transaction in two.
            store.commit(&vec![Write::Episode { record: record(committed % 5), at_ms: 0 }; 2]).await.unwrap();
            committed += 2;
        }
        committed
    });
    let mut counts = Vec::new();
    for number in 0..5 {
        tokio::time::sleep(std::time::Duration::from_millis(30)).await;
        let file = backups.path().join(format!("{number}.db"));
        disk.store.backup(&file).await.unwrap();
        let copy = open(&file).await.unwrap();
        let report = verify_episodes(&Hangar::new(plants(), Models::new(), copy.clone())).await.unwrap();
        assert!(report.holds() && report.identical == report.finished, "{report}");
        counts.push(report.finished);
        copy.close().await;
    }
    stop.store(true, Ordering::Relaxed);
    let committed = writing.await.unwrap();
    assert!(counts.iter().all(|count| count % 2 == 0), "{counts:?}");
    assert!(
        counts.is_sorted() && counts[0] < counts[4] && counts[4] as u64 <= committed,
        "{counts:?} {committed}"
    );
    assert_eq!(files(backups.path()), ["0.db", "1.db", "2.db", "3.db", "4.db"]);
}

#[tokio::test]
async fn nothing_is_overwritten_and_nothing_half_is_left() {
    let (disk, folder) = (Disk::new().await, tempfile::tempdir().unwrap());
    let file = folder.path().join("letter.txt");
    for content in ["", "Dear reader"] {
        fs::write(&file, content).unwrap();
        let refused = disk.store.backup(&file).await;
        assert_eq!(refused, Err(StoreError::Exists { path: file.clone() }));
        assert_eq!(fs::read_to_string(&file).unwrap(), content);
    }
    let nowhere = disk.store.backup(&folder.path().join("no/folder/backup.db")).await;
    assert!(matches!(nowhere, Err(StoreError::Unwritable { .. })), "{nowhere:?}");
    let onto_itself = disk.store.backup(&disk.folder.path().join("flights.db")).await;
    assert!(matches!(onto_itself, Err(StoreError::Exists { .. })), "{onto_itself:?}");
    assert_eq!(files(folder.path()), ["letter.txt"]);
}

#[tokio::test]
async fn two_backups_at_once_do_not_meet() {
    let (disk, folder) = (Disk::new().await, tempfile::tempdir().unwrap());
    disk.store.commit(&vec![Write::Episode { record: record(1), at_ms: 0 }; 20]).await.unwrap();
    let (one, other) = (folder.path().join("one.db"), folder.path().join("other.db"));
    let (first, second) = tokio::join!(disk.store.backup(&one), disk.store.backup(&other));
    assert_eq!((first, second), (Ok(()), Ok(())));
    for file in [one, other] {
        let copy = SqliteStore::open_existing(&file).await.unwrap();
        assert_eq!(copy.episodes(Page::newest(99)).await.unwrap().len(), 20);
        copy.close().await;
    }
    let same = folder.path().join("same.db");
    let (first, second) = tokio::join!(disk.store.backup(&same), disk.store.backup(&same));
    assert!(first.is_ok() != second.is_ok(), "{first:?} {second:?}");
    assert_eq!(files(folder.path()), ["one.db", "other.db", "same.db"]);
}

#[tokio::test]
async fn a_backup_can_be_restored_into_a_new_file_and_into_no_other() {
    let (disk, folder) = (Disk::new().await, tempfile::tempdir().unwrap());
    disk.store.commit(&vec![Write::Episode { record: record(1), at_ms: 0 }; 3]).await.unwrap();
    let (backup, new) = (folder.path().join("backup.db"), folder.path().join("new.db"));
    disk.store.backup(&backup).await.unwrap();
    restore(&backup, &new).await.unwrap();
    let restored = SqliteStore::open_existing(&new).await.unwrap();
    assert_eq!(restored.episodes(Page::newest(9)).await, disk.store.episodes(Page::newest(9)).await);
    let again = restore(&backup, &new).await.unwrap_err();
    assert_eq!(again, StoreError::NotEmpty { database: name(&new) });
}
