//! What the participant's page asks: open the session, the steps that remain, an answer to one of them.

use super::flights::committed_ticks;
use super::people::{Known, Meeting, Seen};
use super::run::Study;
use crate::app::Problem;
use crate::app::{Asking, OfStudy};
use crate::cookies::Cookie;
use crate::secret::random;
use crate::server::Server;
use crate::store::{ParticipantId, Write, now_ms};
use axum::Json;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use cohelm_study::design::schedule::{assign, tallies};
use cohelm_study::design::timeline::ShownContent;
use cohelm_study::session::{AnswerError, Event, Session};
use serde::Deserialize;
use serde_json::{Value, json};

/// Most characters of the name that a tab gives itself.
const MAX_TAB: usize = 64;
/// Most bytes of what a page says of its browser.
const MAX_CLIENT: usize = 4 * 1024;

/// A page opens the session.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Open {
    tab: String,
    #[serde(default)]
    client: Value,
}

/// Makes this tab the live one.
pub async fn open(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Json(Open { tab, client }): Json<Open>,
) -> Result<Json<Value>, Problem> {
    study.let_ask(id).map_err(Problem::too_often)?;
    if tab.is_empty() || tab.len() > MAX_TAB || client.to_string().len() > MAX_CLIENT {
        let words =
            format!("a tab has a name of 1 to {MAX_TAB} bytes, and says at most {MAX_CLIENT} of itself");
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words));
    }
    let met = study.people().meet(id).await?;
    let mut events = Vec::new();
    if met.session.live_tab().is_some_and(|live| live != tab) {
        events.push(Event::TakenOver { tab: tab.clone() });
    }
    events.push(Event::Opened { tab, client });
    let (met, _) = study.people().write(met, Vec::new(), events).await?;
    Ok(Json(shown(&server, &study, &met).await?))
}

/// The session as it stands.
pub async fn session(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Asking(id): Asking,
) -> Result<Json<Value>, Problem> {
    study.let_ask(id).map_err(Problem::too_often)?;
    let met = study.people().meet(id).await?;
    Ok(Json(shown(&server, &study, &met).await?))
}

/// An answer to a step.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    tab: String,
    #[serde(default)]
    data: Value,
    #[serde(default)]
    page_ms: Option<f64>,
}

/// Takes an answer; gives the session after it. One that came before is answered in the same way and changes nothing.
pub async fn answer(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Path(step): Path<String>,
    Json(answer): Json<Answer>,
) -> Result<Json<Value>, Problem> {
    // Only one consents at a time, so that two who come at once are not given the same order.
    let _order = if step == "consent" { Some(study.assigning().await) } else { None };
    let others =
        if step == "consent" { study.people().all(&study.edition().hash).await? } else { Vec::new() };
    let met = live(&study, id, &answer.tab).await?;
    let mut events = match met.session.accept(&met.edition.design, &step, &answer.data) {
        Ok(events) => events,
        Err(error) => return Err(refused(&server, &study, &met, &error).await?),
    };
    for event in &mut events {
        if let Event::StepDone { page_ms, .. } = event {
            *page_ms = answer.page_ms.filter(|ms| ms.is_finite() && *ms >= 0.0);
        }
    }
    let consents = matches!(events.first(), Some(Event::StepDone { step, .. }) if step == "consent");
    if consents && met.session.assignment().is_none() {
        events.push(assigned(&met, &others)?);
    }
    let wrong = events.iter().find_map(|event| match event {
        Event::QuizMissed { wrong } => Some(wrong.clone()),
        _ => None,
    });
    let (met, _) = study.people().write(met, Vec::new(), events).await?;
    let mut session = shown(&server, &study, &met).await?;
    if let Some(wrong) = wrong {
        session["wrong"] = json!(wrong);
    }
    Ok(Json(session))
}

/// The order in which the participant flies the conditions, given how far the others are.
fn assigned(met: &Known, others: &[Seen]) -> Result<Event, Problem> {
    let design = &met.edition.design;
    let heard_of = |seen: &Seen| seen.row.seen_at_ms.unwrap_or(seen.row.created_at_ms);
    let people = others
        .iter()
        .filter(|seen| seen.edition.hash == met.edition.hash)
        .map(|seen| (seen.session.as_ref(), heard_of(seen)));
    let tallies = tallies(design, people, now_ms(), met.session.is_simulated());
    let given = assign(design, &tallies, u64::from_le_bytes(random()?));
    Ok(Event::Assigned {
        cell: given.cell,
        order: given.order,
        seed: given.seed,
        design: met.edition.hash.clone(),
    })
}

async fn refused(
    server: &Server,
    study: &Study,
    met: &Meeting,
    error: &AnswerError,
) -> Result<Problem, Problem> {
    let words = error.to_string();
    Ok(match error {
        AnswerError::Items { items } => {
            Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words).with("items", json!(items))
        }
        AnswerError::SlowDevice => {
            Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words).with("slow_device", true)
        }
        _ => Problem::new(StatusCode::CONFLICT, words).with("session", shown(server, study, met).await?),
    })
}

/// Which language to go on in.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Language {
    language: String,
    tab: Option<String>,
}

/// The participant chooses a language of the study.
pub async fn language(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Json(Language { language, tab }): Json<Language>,
) -> Result<Json<Value>, Problem> {
    let met = match tab {
        Some(tab) => live(&study, id, &tab).await?,
        None => study.people().meet(id).await?,
    };
    if !met.edition.design.languages.contains(&language) {
        let words = format!("the study speaks {}", met.edition.design.languages.join(", "));
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words));
    }
    let same = met.session.language() == language;
    let events = if same { Vec::new() } else { vec![Event::LanguageChosen { language }] };
    let (met, _) = study.people().write(met, Vec::new(), events).await?;
    Ok(Json(shown(&server, &study, &met).await?))
}

/// A request with nothing but the tab.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OfTab {
    tab: String,
}

/// The participant withdraws: everything that is kept of them goes.
pub async fn withdraw(
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Json(OfTab { tab }): Json<OfTab>,
) -> Result<Response, Problem> {
    let met = live(&study, id, &tab).await?;
    erase(&study, met, "participant").await?;
    let forget = [(header::SET_COOKIE, Cookie::Participant.clear(study.is_secure()))];
    Ok((forget, Json(json!({ "status": "withdrawn" }))).into_response())
}

/// Deletes everything of a participant but that there was one, who withdrew.
pub(super) async fn erase(study: &Study, met: Meeting, by: &str) -> Result<(), Problem> {
    let session = &met.session;
    let (test, simulated) = (session.is_test(), session.is_simulated());
    let invited = Event::Invited { test, simulated, language: None, panel: Default::default(), note: None };
    let left = [invited, Event::Withdrawn { by: by.into() }];
    let left =
        left.iter().map(|event| serde_json::to_string(event).expect("words have a JSON form")).collect();
    let write = Write::Withdraw { participant: met.row.id, left, at_ms: now_ms() };
    study.people().overwrite(met, vec![write]).await?;
    study.people().forget_tokens();
    Ok(())
}

/// Meets the participant, if the tab is the live one.
pub(super) async fn live(study: &Study, id: ParticipantId, tab: &str) -> Result<Meeting, Problem> {
    study.let_ask(id).map_err(Problem::too_often)?;
    let met = study.people().meet(id).await?;
    match met.session.live_tab() {
        Some(live) if live == tab => Ok(met),
        Some(_) => {
            let words = "the study goes on in another tab; close this one, or reload it to go on here";
            Err(Problem::new(StatusCode::CONFLICT, words).with("taken_over", true))
        }
        None => Err(Problem::new(StatusCode::CONFLICT, "open the session first").with("taken_over", false)),
    }
}

/// The session for the page.
pub(super) async fn shown(server: &Server, study: &Study, met: &Meeting) -> Result<Value, Problem> {
    let Known { row, edition, session, .. } = &**met;
    let design = &edition.design;
    let resolved = study.resolved(edition, server.learning());
    let unresolved = |error: cohelm_study::design::timeline::Unresolved| {
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
    };
    let mut steps = session.shown(design, &resolved).map_err(unresolved)?;
    if let Some(ShownContent::Flight(flight)) = steps.first_mut().map(|step| &mut step.content) {
        flight.committed_ticks = committed_ticks(server, session).await?;
    }
    let language = session.language();
    Ok(json!({
        "study": {
            "title": design.title.read(language, design.first_language()),
            "languages": design.languages,
            "contact": design.contact,
            "version": design.consent.version,
        },
        "participant": {
            "code": row.code,
            "test": session.is_test(),
            "simulated": session.is_simulated(),
            "language": language,
        },
        "status": session.status(),
        "place": session.place(),
        "total": session.steps().len(),
        "minutes_left": session.minutes_left(design),
        "return_address": ended_elsewhere(session, design),
        "steps": steps,
        "server_ms": now_ms(),
    }))
}

/// Where somebody goes back to for whom the session ended without a last step: who declined or was left out.
fn ended_elsewhere(session: &Session, design: &cohelm_study::design::Design) -> Option<String> {
    if session.current().is_some() { None } else { session.return_address(design) }
}

/// What a page may say of a flight over HTTP.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlightNote {
    tab: String,
    begun: Option<Begun>,
    interrupted: Option<Interrupted>,
    resumed: Option<Resumed>,
}

/// The page begins a flight.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Begun {
    clock_offset_ms: Option<f64>,
}

/// It went away from it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interrupted {
    tick: u32,
    reason: String,
}

/// It goes on.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resumed {
    tick: u32,
    source: String,
    away_ms: i64,
}

/// Most bytes of a reason or source.
const MAX_WORDS: usize = 200;

/// Notes what happened to the flight in the air.
pub async fn note_flight(
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Path(key): Path<String>,
    Json(note): Json<FlightNote>,
) -> Result<Json<Value>, Problem> {
    let met = live(&study, id, &note.tab).await?;
    let step = met.session.current().filter(|_| met.session.current_key().as_deref() == Some(&key));
    let Some(step) = step.map(|step| step.id.clone()) else {
        let words = "no flight of this key is to be flown now; ask for the session again";
        return Err(Problem::new(StatusCode::CONFLICT, words));
    };
    let attempt = met.session.attempt(&step);
    let mut events = Vec::new();
    if let Some(Begun { clock_offset_ms }) = note.begun {
        study.note_clock(id, clock_offset_ms.filter(|ms| ms.is_finite()));
    }
    if let Some(Interrupted { tick, reason }) = note.interrupted {
        let (step, reason) = (step.clone(), crate::protocol::cut(&reason, MAX_WORDS).into());
        events.push(Event::FlightInterrupted { step, attempt, tick, reason });
    }
    if let Some(Resumed { tick, source, away_ms }) = note.resumed {
        let source = crate::protocol::cut(&source, MAX_WORDS).into();
        events.push(Event::FlightResumed { step, attempt, tick, source, away_ms });
    }
    study.people().write(met, Vec::new(), events).await?;
    Ok(Json(json!({ "noted": true, "server_ms": now_ms() })))
}
