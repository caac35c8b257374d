//! Secrets: tokens that the server draws, and the researcher's own, of which only a hash is kept.

use argon2::Argon2;
use argon2::password_hash::{PasswordHash, PasswordHasher, PasswordVerifier, SaltString};
use sha2::{Digest, Sha256};
use std::fmt;

/// Bytes of a token, 128 bits: nobody guesses one at any rate at which a server answers.
const TOKEN_BYTES: usize = 16;
/// Fewest bytes of the researcher's secret; shorter ones are guessed in spite of the limit on attempts.
pub const LEAST_SECRET: usize = 8;
/// Most bytes of it: hashing more would only cost time.
pub const MOST_SECRET: usize = 1024;

/// Why there is no secret.
#[derive(Debug, thiserror::Error)]
pub enum SecretError {
    /// The system gives no random bytes.
    #[error("the system gives no random bytes: {0}")]
    Random(#[from] getrandom::Error),
    /// Too short or too long.
    #[error("the secret must have {LEAST_SECRET} to {MOST_SECRET} bytes, this one has {0}")]
    Length(usize),
    /// A stored hash is none.
    #[error("the stored hash of the secret cannot be read: {0}; choose a new secret")]
    Hash(String),
}

/// 128 random bits as 32 hexadecimal digits: a participant's link, or a cookie. Never logged; kept only as a hash.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    /// A new one.
    pub fn draw() -> Result<Self, SecretError> {
        Ok(Self(hex(&random::<TOKEN_BYTES>()?)))
    }

    /// What looks like one; `None` if it does not.
    pub fn read(text: &str) -> Option<Self> {
        let digits = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        (digits && text.len() == 2 * TOKEN_BYTES).then(|| Self(text.into()))
    }

    /// What is kept of it. A token has 128 random bits, so that a plain hash is enough.
    pub fn hash(&self) -> [u8; 32] {
        Sha256::digest(self.0.as_bytes()).into()
    }

    /// Its text, for whom it is drawn.
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// So many random bytes of the system.
pub fn random<const N: usize>() -> Result<[u8; N], SecretError> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes)?;
    Ok(bytes)
}

/// Lower-case hexadecimal digits of bytes.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What is kept of the researcher's secret: argon2id with a salt of its own (19 MiB, two passes).
#[derive(Clone)]
pub struct SecretHash(String);

impl fmt::Debug for SecretHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SecretHash(..)")
    }
}

impl SecretHash {
    /// The hash of a secret; takes some 20 ms.
    pub fn of(secret: &str) -> Result<Self, SecretError> {
        if !(LEAST_SECRET..=MOST_SECRET).contains(&secret.len()) {
            return Err(SecretError::Length(secret.len()));
        }
        let unreadable = |error: argon2::password_hash::Error| SecretError::Hash(error.to_string());
        let salt = SaltString::encode_b64(&random::<16>()?).map_err(unreadable)?;
        let hash = Argon2::default().hash_password(secret.as_bytes(), &salt).map_err(unreadable)?;
        Ok(Self(hash.to_string()))
    }

    /// A hash as [`text`](Self::text) gave it.
    pub fn read(text: &str) -> Result<Self, SecretError> {
        PasswordHash::new(text).map_err(|error| SecretError::Hash(error.to_string()))?;
        Ok(Self(text.into()))
    }

    /// The text to keep (PHC string format).
    pub fn text(&self) -> &str {
        &self.0
    }

    /// True for the secret that it was made of. Takes as long for a wrong one.
    pub fn fits(&self, secret: &str) -> bool {
        let hash = PasswordHash::new(&self.0);
        secret.len() <= MOST_SECRET
            && hash.is_ok_and(|hash| Argon2::default().verify_password(secret.as_bytes(), &hash).is_ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn tokens_are_different_have_128_bits_and_show_themselves_in_no_log() {
        let drawn: HashSet<String> = (0..200).map(|_| Token::draw().unwrap().text().to_owned()).collect();
        assert_eq!(drawn.len(), 200);
        assert!(drawn.iter().all(|text| text.len() * 4 == 128 && Token::read(text).is_some()));
        let token = Token::draw().unwrap();
        assert!(!format!("{token:?}").contains(token.text()));
        for wrong in ["", "0", &"g".repeat(32), &"A".repeat(32), &"0".repeat(33), "../../etc/passwd"] {
            assert!(Token::read(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn what_is_kept_of_a_token_is_its_sha_256() {
        // printf 00000000000000000000000000000000 | sha256sum
        let kept = Token::read(&"0".repeat(32)).unwrap().hash();
        assert_eq!(hex(&kept), "84e0c0eafaa95a34c293f278ac52e45ce537bab5e752a00e6959a13ae103b65a");
    }

    #[test]
    fn only_the_secret_itself_fits_its_hash_which_is_argon2id_with_its_own_salt() {
        let (one, other) =
            (SecretHash::of("correct horse").unwrap(), SecretHash::of("correct horse").unwrap());
        assert!(one.text().starts_with("$argon2id$v=19$m=19456,t=2,p=1$") && one.text() != other.text());
        assert!(!one.text().contains("correct") && !format!("{one:?}").contains("argon2"));
        let again = SecretHash::read(one.text()).unwrap();
        assert!(again.fits("correct horse"));
        for wrong in ["", "correct horse ", "Correct horse", &"x".repeat(MOST_SECRET + 1)] {
            assert!(!again.fits(wrong), "{wrong}");
        }
    }

    #[test]
    fn short_secrets_and_damaged_hashes_are_refused_with_a_reason() {
        assert!(SecretHash::of("1234567").unwrap_err().to_string().contains("8 to 1024"));
        assert!(SecretHash::of(&"x".repeat(MOST_SECRET + 1)).is_err());
        assert!(SecretHash::read("plain").is_err());
    }
}
