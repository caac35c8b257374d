//! Cookies: the participant's and the researcher's.

use crate::secret::Token;
use axum::http::{HeaderMap, HeaderValue, header};

/// Longest time between a participant's sessions, seconds: 90 days.
const PARTICIPANT_AGE_S: u32 = 90 * 24 * 3600;

/// Which cookie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cookie {
    /// The participant's: outlives the browser, and comes along when a link elsewhere leads here, so that opening the
    /// study's link again leads back to the same place. It never comes along with what another site's page posts.
    Participant,
    /// The researcher's: goes with the browser, and comes along from nowhere else.
    Desk,
}

impl Cookie {
    fn name(self) -> &'static str {
        match self {
            Self::Participant => "cohelm_participant",
            Self::Desk => "cohelm_desk",
        }
    }

    /// The token that a request brings under this name.
    pub fn read(self, headers: &HeaderMap) -> Option<Token> {
        let lines = headers.get_all(header::COOKIE).iter().filter_map(|line| line.to_str().ok());
        let mut pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
        pairs.find(|(name, _)| *name == self.name()).and_then(|(_, value)| Token::read(value))
    }

    /// The header that makes a browser keep the token; `secure` keeps it from ever going over plain HTTP.
    pub fn set(self, token: &Token, secure: bool) -> HeaderValue {
        let rest = match self {
            Self::Participant => format!("SameSite=Lax; Max-Age={PARTICIPANT_AGE_S}"),
            Self::Desk => "SameSite=Strict".into(),
        };
        self.header(token.text(), &rest, secure)
    }

    /// The header that makes a browser forget it.
    pub fn clear(self, secure: bool) -> HeaderValue {
        self.header("", "SameSite=Strict; Max-Age=0", secure)
    }

    fn header(self, value: &str, rest: &str, secure: bool) -> HeaderValue {
        let secure = if secure { "; Secure" } else { "" };
        let text = format!("{}={value}; Path=/; HttpOnly; {rest}{secure}", self.name());
        HeaderValue::try_from(text).expect("hexadecimal digits and words are a header's value")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cookie_is_found_among_others_and_only_a_token_is_one() {
        let token = Token::draw().unwrap();
        let mut headers = HeaderMap::new();
        headers.append(header::COOKIE, HeaderValue::from_static("theme=dark; cohelm_desk=nonsense"));
        let line = format!("a=b; cohelm_participant={}; c", token.text());
        headers.append(header::COOKIE, line.parse().unwrap());
        assert_eq!(Cookie::Participant.read(&headers), Some(token));
        assert_eq!(Cookie::Desk.read(&headers), None);
    }

    #[test]
    fn no_script_reads_a_cookie_no_other_site_sends_it_and_under_tls_it_never_goes_in_the_clear() {
        let token = Token::draw().unwrap();
        for cookie in [Cookie::Participant, Cookie::Desk] {
            let plain = cookie.set(&token, false).to_str().unwrap().to_owned();
            assert!(plain.contains("; HttpOnly; SameSite=") && !plain.contains("Secure"), "{plain}");
            assert!(cookie.set(&token, true).to_str().unwrap().ends_with("; Secure"));
            assert!(cookie.clear(true).to_str().unwrap().contains("Max-Age=0"));
        }
        assert!(Cookie::Desk.set(&token, true).to_str().unwrap().contains("SameSite=Strict"));
    }
}
