//! Who may ask for what: each route names a right, and one place decides.

use super::problem::Problem;
use crate::cookies::Cookie;
use crate::server::Server;
use crate::store::ParticipantId;
use crate::study::Study;
use axum::extract::{FromRequestParts, Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

/// What only our own page's scripts send: a form of another site cannot set a header.
pub(crate) const DESK_HEADER: HeaderName = HeaderName::from_static("x-cohelm-desk");

/// What somebody must be to ask for a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Right {
    /// Nobody in particular.
    Anyone,
    /// Nobody in particular, where a study is run: the ways in.
    Entrance,
    /// Whoever flies: everybody where no study is run, otherwise a participant or the researcher.
    Flyer,
    /// Whoever the flights belong to: everybody where no study is run, otherwise the researcher.
    Owner,
    /// A participant of the study.
    Participant,
    /// The researcher, by the cookie of the desk.
    Researcher,
    /// The researcher, by the cookie or, from a program, by the secret itself.
    Recorder,
}

/// Who asks, as the cookies say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Who {
    /// This participant.
    pub participant: Option<ParticipantId>,
    /// A researcher who has shown the secret.
    pub researcher: bool,
}

/// The study of this server; extracted by the handlers that need one.
pub(crate) struct OfStudy(pub Arc<Study>);

/// The participant who asks; extracted by handlers behind [`Right::Participant`].
pub(crate) struct Asking(pub ParticipantId);

impl FromRequestParts<Server> for OfStudy {
    type Rejection = Problem;

    async fn from_request_parts(_: &mut Parts, server: &Server) -> Result<Self, Problem> {
        server.study().cloned().map(Self).ok_or_else(no_study)
    }
}

impl FromRequestParts<Server> for Asking {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &Server) -> Result<Self, Problem> {
        let who = parts.extensions.get::<Who>().copied().unwrap_or_default();
        who.participant.map(Self).ok_or_else(no_participant)
    }
}

/// Lets the request through if whoever asks has the right, and notes who it is.
pub(crate) async fn admit(
    State((server, right)): State<(Server, Right)>,
    mut request: Request,
    next: Next,
) -> Response {
    let ours = request.method().is_safe() || request.headers().contains_key(DESK_HEADER);
    match allowed(&server, right, request.headers(), ours).await {
        Ok(who) => {
            request.extensions_mut().insert(who);
            next.run(request).await
        }
        Err(problem) => problem.into_response(),
    }
}

/// `ours`: the request reads only, or has the header that only our page's scripts send.
async fn allowed(server: &Server, right: Right, headers: &HeaderMap, ours: bool) -> Result<Who, Problem> {
    let Some(study) = server.study() else {
        return match right {
            Right::Anyone | Right::Flyer | Right::Owner => Ok(Who::default()),
            _ => Err(no_study()),
        };
    };
    if matches!(right, Right::Anyone | Right::Entrance) {
        return Ok(Who::default());
    }
    let who = who(study, headers).await?;
    match right {
        Right::Participant => who.participant.map(|_| who).ok_or_else(no_participant),
        Right::Flyer if who.participant.is_some() || who.researcher => Ok(who),
        Right::Flyer => Err(no_participant()),
        Right::Recorder if !who.researcher => by_secret(study, headers).await,
        _ if !who.researcher => Err(no_researcher()),
        _ if !ours => Err(Problem::new(StatusCode::FORBIDDEN, "the header x-cohelm-desk is missing")),
        _ => Ok(who),
    }
}

async fn who(study: &Study, headers: &HeaderMap) -> Result<Who, Problem> {
    let researcher = Cookie::Desk.read(headers).is_some_and(|token| study.door().knows(&token));
    let participant = match Cookie::Participant.read(headers) {
        Some(token) => study.people().of_token(&token).await?,
        None => None,
    };
    Ok(Who { participant, researcher })
}

/// A program that is no browser sends the secret with each request.
async fn by_secret(study: &Study, headers: &HeaderMap) -> Result<Who, Problem> {
    let bearer = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let secret = bearer.and_then(|value| value.strip_prefix("Bearer ")).ok_or_else(no_researcher)?;
    study.door().check(secret).await?;
    Ok(Who { participant: None, researcher: true })
}

fn no_study() -> Problem {
    Problem::not_found("no study is run here")
}

fn no_participant() -> Problem {
    Problem::new(
        StatusCode::UNAUTHORIZED,
        "open your link to the study again; this browser is not known here",
    )
}

fn no_researcher() -> Problem {
    Problem::new(StatusCode::UNAUTHORIZED, "log in to the researcher's page first")
}
