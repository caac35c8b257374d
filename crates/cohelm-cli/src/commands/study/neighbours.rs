//! Who else is on the database that a study is run on: participants of other versions of its file, another program.

use anyhow::Result;
use cohelm_server::store::Store;
use cohelm_study::design::Design;
use std::ffi::OsStr;
use std::fs::{File, TryLockError};
use std::path::PathBuf;

/// A line about participants of other versions of the study's file, if there are some.
pub async fn other_versions(store: &dyn Store, design: &Design) -> Result<Option<String>> {
    let (mut versions, mut participants) = (0, 0);
    for stored in store.studies().await? {
        if stored.name != design.name || stored.hash == design.hash() {
            continue;
        }
        let here = store.participants(&stored.hash).await?.len();
        participants += here;
        versions += usize::from(here > 0);
    }
    let of = if versions == 1 { "another version".to_owned() } else { format!("{versions} other versions") };
    let are = if participants == 1 {
        "1 participant is".to_owned()
    } else {
        format!("{participants} participants are")
    };
    Ok((participants > 0).then(|| {
        format!("{are} here of {of} of this file: they go on with theirs, new ones get this one; reports are one a version")
    }))
}

/// What says, as long as it lives, that a study is run on a database in a file.
pub struct Running {
    mark: PathBuf,
    _locked: File,
}

impl Running {
    /// Marks a database as in use. An error's words if another program has marked it; nothing for a database on a server,
    /// or where marks cannot be made.
    pub fn mark(database: &OsStr) -> Result<Option<Self>, String> {
        if database.to_string_lossy().contains("://") {
            return Ok(None);
        }
        let mut mark = database.to_owned();
        mark.push("-running");
        let mark = PathBuf::from(mark);
        let Ok(locked) = File::options().create(true).append(true).open(&mark) else { return Ok(None) };
        match locked.try_lock() {
            Ok(()) => Ok(Some(Self { mark, _locked: locked })),
            Err(TryLockError::WouldBlock) => Err(
                "another `cohelm study run` is on this database: what participants do there does not show live on this \
                 desk; end one of the two"
                    .into(),
            ),
            Err(TryLockError::Error(_)) => Ok(None),
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.mark);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm_server::store::{ParticipantId, SqliteStore, TokenHash, Write};

    fn pilot() -> Design {
        Design::from_toml(include_str!("../../../../../studies/pilot.toml"))
            .expect("shipped with the project")
    }

    #[tokio::test]
    async fn participants_of_another_version_of_the_file_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let store = SqliteStore::open(&folder.path().join("study.db")).await.unwrap();
        let design = pilot();
        let study =
            |hash: String| Write::Study { hash, name: design.name.clone(), text: "t".into(), at_ms: 1 };
        let participant = |number: i64, study: String| Write::Participant {
            id: ParticipantId(number),
            study,
            code: format!("code-{number}"),
            token: TokenHash([number as u8; 32]),
            at_ms: 2,
        };
        let other = "ab".repeat(32);
        store
            .commit(&[study(design.hash()), participant(1, design.hash()), study(other.clone())])
            .await
            .unwrap();
        assert_eq!(other_versions(&store, &design).await.unwrap(), None, "nobody has the other version");
        store.commit(&[participant(2, other)]).await.unwrap();
        let said = other_versions(&store, &design).await.unwrap().expect("somebody has it");
        assert!(said.starts_with("1 participant is here of another version of this file"), "{said}");
    }

    #[test]
    fn a_second_program_on_a_database_is_told_and_the_mark_goes_with_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let database = folder.path().join("study.db");
        let first = Running::mark(database.as_os_str()).unwrap().expect("a file");
        assert!(
            Running::mark(database.as_os_str())
                .err()
                .expect("the first one runs")
                .contains("end one of the two")
        );
        drop(first);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(Running::mark(database.as_os_str()).unwrap().is_some());
        assert!(Running::mark(OsStr::new("postgres://localhost/study")).unwrap().is_none());
    }
}
