//! The researcher's door: one secret, few attempts, sessions in memory that end with the server.

use crate::limits::{Bucket, OF_LOGINS};
use crate::secret::{SecretError, SecretHash, Token};
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::Instant;

/// A session that asked for nothing so long is over.
pub const IDLE: Duration = Duration::from_secs(12 * 3600);
/// Sessions at once; another one ends the one that asked least lately.
const MOST_SESSIONS: usize = 64;

/// Why nobody was let in.
#[derive(Debug, thiserror::Error)]
pub enum LoginError {
    /// Not the secret.
    #[error("that is not the secret")]
    Wrong,
    /// Too many attempts.
    #[error("too many attempts; wait {} s", .0.as_secs() + 1)]
    TooOften(Duration),
    /// No token can be drawn.
    #[error(transparent)]
    Secret(#[from] SecretError),
}

/// Who holds the secret, and who has shown it.
pub struct Doorkeeper {
    secret: SecretHash,
    attempts: Mutex<Bucket>,
    sessions: Mutex<HashMap<[u8; 32], Instant>>,
}

impl Doorkeeper {
    /// Lets in whoever has the secret of this hash.
    pub fn new(secret: SecretHash) -> Self {
        Self { secret, attempts: Mutex::new(Bucket::new(OF_LOGINS)), sessions: Mutex::default() }
    }

    /// Fails unless that is the secret; counts as an attempt. Takes some 20 ms on a thread that may be kept.
    pub async fn check(&self, secret: &str) -> Result<(), LoginError> {
        lock(&self.attempts).take().map_err(LoginError::TooOften)?;
        let (hash, secret) = (self.secret.clone(), secret.to_owned());
        let fits = tokio::task::spawn_blocking(move || hash.fits(&secret)).await;
        if fits.unwrap_or(false) { Ok(()) } else { Err(LoginError::Wrong) }
    }

    /// A session for whoever has the secret.
    pub async fn log_in(&self, secret: &str) -> Result<Token, LoginError> {
        self.check(secret).await?;
        let token = Token::draw()?;
        let mut sessions = lock(&self.sessions);
        sessions.retain(|_, asked| asked.elapsed() < IDLE);
        if sessions.len() >= MOST_SESSIONS {
            let idlest = sessions.iter().min_by_key(|(_, asked)| **asked).map(|(hash, _)| *hash);
            idlest.and_then(|hash| sessions.remove(&hash));
        }
        sessions.insert(token.hash(), Instant::now());
        Ok(token)
    }

    /// True if the token is one of a session, which goes on for another while.
    pub fn knows(&self, token: &Token) -> bool {
        let mut sessions = lock(&self.sessions);
        let hash = token.hash();
        match sessions.get_mut(&hash) {
            Some(asked) if asked.elapsed() < IDLE => {
                *asked = Instant::now();
                true
            }
            Some(_) => {
                sessions.remove(&hash);
                false
            }
            None => false,
        }
    }

    /// Ends a session.
    pub fn log_out(&self, token: &Token) {
        lock(&self.sessions).remove(&token.hash());
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic elsewhere leaves what is inside as it was.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::time::{advance, pause};

    fn door() -> Doorkeeper {
        Doorkeeper::new(SecretHash::of("correct horse").unwrap())
    }

    #[tokio::test]
    async fn whoever_has_the_secret_gets_a_session_until_it_ends() {
        let door = door();
        assert!(matches!(door.log_in("wrong").await, Err(LoginError::Wrong)));
        let token = door.log_in("correct horse").await.unwrap();
        assert!(door.knows(&token) && !door.knows(&Token::draw().unwrap()));
        door.log_out(&token);
        assert!(!door.knows(&token));
    }

    #[tokio::test]
    async fn a_session_ends_when_nobody_asks_for_long() {
        let door = door();
        let token = door.log_in("correct horse").await.unwrap();
        pause();
        advance(IDLE / 2).await;
        assert!(door.knows(&token));
        advance(IDLE / 2).await;
        assert!(door.knows(&token), "what was asked keeps it going");
        advance(IDLE).await;
        assert!(!door.knows(&token));
    }

    #[tokio::test]
    async fn after_ten_attempts_even_the_right_one_waits() {
        let door = door();
        for _ in 0..OF_LOGINS.burst as usize {
            assert!(matches!(door.log_in("wrong").await, Err(LoginError::Wrong)));
        }
        let error = door.log_in("correct horse").await.unwrap_err();
        assert!(matches!(error, LoginError::TooOften(_)) && error.to_string().contains("wait"), "{error}");
        pause();
        advance(Duration::from_secs(6)).await;
        assert!(door.log_in("correct horse").await.is_ok());
    }

    #[tokio::test]
    async fn no_more_sessions_are_kept_than_researchers_have() {
        let door = door();
        let first = door.log_in("correct horse").await.unwrap();
        pause();
        for _ in 0..MOST_SESSIONS {
            advance(Duration::from_secs(5)).await;
            door.log_in("correct horse").await.unwrap();
        }
        assert_eq!(lock(&door.sessions).len(), MOST_SESSIONS);
        assert!(!door.knows(&first));
    }
}
