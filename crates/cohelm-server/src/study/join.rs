//! How somebody becomes a participant: by a link of their own, or by the open one.

use super::people::Seen;
use super::run::Study;
use crate::app::{OfStudy, Problem};
use crate::cookies::Cookie;
use crate::secret::{Token, random};
use crate::server::Server;
use crate::store::{ParticipantId, StoreError, TokenHash, Write, now_ms};
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use cohelm_study::session::{Event, Status};
use std::collections::{BTreeMap, HashMap};

/// Where a participant goes on.
const PAGE: &str = "/study";
/// Most bytes of a parameter of the panel.
const MAX_PARAMETER: usize = 200;
/// Fewest characters of a panel's name for a participant that is taken as proof of who comes: Prolific's have 24. Who
/// comes again with a shorter one, which others could guess, needs the browser they began with, or a new link.
const LEAST_PROOF: usize = 16;
/// Attempts at a number and a code that nobody else has.
const ATTEMPTS: usize = 8;

/// A link of somebody's own.
pub async fn by_link(OfStudy(study): OfStudy, Path(token): Path<String>) -> Result<Response, Problem> {
    study.let_in().map_err(Problem::too_often)?;
    let unknown = || {
        Problem::not_found(
            "this link is not valid, or was replaced by a newer one; ask the researcher for a new link",
        )
    };
    let token = Token::read(&token).ok_or_else(unknown)?;
    study.people().of_token(&token).await?.ok_or_else(unknown)?;
    Ok(enter(&study, &token))
}

/// The open link, with what the panel says of who comes.
pub async fn openly(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Query(said): Query<HashMap<String, String>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    study.let_join().map_err(Problem::too_often)?;
    let design = &study.edition().design;
    if !design.has_open_link() {
        return Err(Problem::new(StatusCode::FORBIDDEN, "this study is joined by a link of one's own"));
    }
    let panel = panel_of(&study, &said)?;
    if let Some(known) = returning(&study, &headers).await? {
        return Ok(enter(&study, &known));
    }
    if let Some(before) = same_person(&study, &panel).await? {
        return again(&server, &study, &before, &panel).await;
    }
    let language = said.get("lang").filter(|code| design.languages.contains(*code)).cloned();
    let event = Event::Invited { test: false, simulated: false, language, panel, note: None };
    let (_, _, token) = invite(&server, &study, event).await?;
    Ok(enter(&study, &token))
}

/// The parameters that the design stores, as they were said.
fn panel_of(study: &Study, said: &HashMap<String, String>) -> Result<BTreeMap<String, String>, Problem> {
    let Some(panel) = &study.edition().design.panel else { return Ok(BTreeMap::new()) };
    let mut kept = BTreeMap::new();
    for name in &panel.parameters {
        let Some(value) = said.get(name) else { continue };
        if value.len() > MAX_PARAMETER || value.chars().any(char::is_control) {
            let words = format!("{name} has at most {MAX_PARAMETER} bytes, none of them a control character");
            return Err(Problem::new(StatusCode::BAD_REQUEST, words));
        }
        kept.insert(name.clone(), value.clone());
    }
    Ok(kept)
}

/// The token of whom this browser knows already.
async fn returning(study: &Study, headers: &HeaderMap) -> Result<Option<Token>, Problem> {
    let Some(token) = Cookie::Participant.read(headers) else { return Ok(None) };
    let Some(id) = study.people().of_token(&token).await? else { return Ok(None) };
    let met = study.people().meet(id).await?;
    let goes_on =
        !matches!(met.session.status(), Status::Withdrawn) && met.edition.hash == study.edition().hash;
    Ok(goes_on.then_some(token))
}

/// Who came before under the panel's same name.
async fn same_person(study: &Study, panel: &BTreeMap<String, String>) -> Result<Option<Seen>, Problem> {
    let named =
        study.edition().design.panel.as_ref().and_then(|design| panel.get_key_value(&design.participant));
    let Some((parameter, name)) = named else { return Ok(None) };
    let all = study.people().all(&study.edition().hash).await?;
    let same = |seen: &Seen| seen.session.panel().get(parameter) == Some(name);
    Ok(all.into_iter().find(same))
}

/// Somebody whom the panel sends again: a new link of theirs, if the panel's name proves who they are.
async fn again(
    server: &Server,
    study: &Study,
    before: &Seen,
    panel: &BTreeMap<String, String>,
) -> Result<Response, Problem> {
    let design = study.edition().design.panel.as_ref();
    let proof =
        design.and_then(|design| panel.get(&design.participant)).map_or(0, |name| name.chars().count());
    if proof < LEAST_PROOF {
        let words = "somebody began under this name already; go on in the browser that you began with, or ask the \
                     researcher for a link";
        return Err(Problem::new(StatusCode::CONFLICT, words));
    }
    let token = relink(server, study, before.row.id).await?;
    Ok(enter(study, &token))
}

/// A new link, which voids the old one.
pub(super) async fn relink(server: &Server, study: &Study, id: ParticipantId) -> Result<Token, Problem> {
    let token = Token::draw()?;
    let link = Write::Link { participant: id, token: Some(TokenHash(token.hash())) };
    server.writer().write(vec![link]).await.map_err(|error| Problem::paused(&error))?;
    study.people().forget_tokens();
    study.hub().tell(id);
    Ok(token)
}

/// A new participant; gives number, code and the token of the link.
pub(super) async fn invite(
    server: &Server,
    study: &Study,
    invited: Event,
) -> Result<(ParticipantId, String, Token), Problem> {
    let event_json = serde_json::to_string(&invited).expect("words have a JSON form");
    let mut last = None;
    for _ in 0..ATTEMPTS {
        let (token, code, at_ms) = (Token::draw()?, new_code()?, now_ms());
        let id = study.new_number(server.store()).await.map_err(|error| Problem::paused(&error))?;
        let hash = study.edition().hash.clone();
        let row =
            Write::Participant { id, study: hash, code: code.clone(), token: TokenHash(token.hash()), at_ms };
        let event_json = event_json.clone();
        let event = Write::Event { participant: id, expected_seq: 1, event_json, at_ms };
        match server.writer().write(vec![row, event]).await {
            Ok(_) => {
                study.hub().tell(id);
                return Ok((id, code, token));
            }
            // Another server on the same database has the number, or somebody, one in a billion, the code.
            Err(error) if error.is_about_one_write() => last = Some(error),
            Err(error) => return Err(Problem::paused(&error)),
        }
    }
    Err(Problem::paused(&last.unwrap_or(StoreError::Stopping)))
}

/// Six characters that are hard to mistake for one another (Crockford's base 32): 30 bits.
fn new_code() -> Result<String, Problem> {
    const LETTERS: &[u8; 32] = b"0123456789ABCDEFGHJKMNPQRSTVWXYZ";
    Ok(random::<6>()?.iter().map(|byte| char::from(LETTERS[usize::from(byte % 32)])).collect())
}

fn enter(study: &Study, token: &Token) -> Response {
    let keep = [(header::SET_COOKIE, Cookie::Participant.set(token, study.is_secure()))];
    (StatusCode::SEE_OTHER, keep, [(header::LOCATION, PAGE)]).into_response()
}
