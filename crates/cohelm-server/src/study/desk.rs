//! What the researcher's page asks: the study in words, its participants, what to do about one of them.

use super::flights::condition_name;
use super::join::{invite, relink};
use super::page::erase;
use super::people::Seen;
use super::rows::Row;
use super::run::Study;
use crate::app::{OfStudy, Problem};
use crate::cookies::Cookie;
use crate::server::Server;
use crate::store::{Episode, EpisodeId, Page, ParticipantId, now_ms};
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::sse::{Event as NewsEvent, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use cohelm_study::design::Design;
use cohelm_study::design::explain::{TOPICS, explain};
use cohelm_study::design::schedule::{cells, tallies};
use cohelm_study::session::{Event, Status};
use futures_util::{Stream, stream};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::convert::Infallible;
use std::time::Duration;

/// Who acts from here, in the log.
const BY: &str = "researcher";
/// Most characters of a note or reason.
const MAX_WORDS: usize = 2_000;
/// Flights of a list unless another number is asked for, and at most.
const USUAL_LIMIT: u32 = 50;
const MOST_LIMIT: u32 = 1_000;
/// Least time between two pieces of news: more frequent ones only make the page ask more often.
const NEWS_EVERY: Duration = Duration::from_millis(500);

/// The secret.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Login {
    secret: String,
}

/// Lets a researcher in.
pub async fn log_in(
    OfStudy(study): OfStudy,
    Json(Login { secret }): Json<Login>,
) -> Result<Response, Problem> {
    let token = study.door().log_in(&secret).await?;
    let keep = [(header::SET_COOKIE, Cookie::Desk.set(&token, study.is_secure()))];
    Ok((keep, Json(json!({ "logged_in": true }))).into_response())
}

/// Ends the researcher's session.
pub async fn log_out(OfStudy(study): OfStudy, headers: HeaderMap) -> Response {
    if let Some(token) = Cookie::Desk.read(&headers) {
        study.door().log_out(&token);
    }
    let forget = [(header::SET_COOKIE, Cookie::Desk.clear(study.is_secure()))];
    (forget, Json(json!({ "logged_in": false }))).into_response()
}

/// The study, how far it is, and its file.
pub async fn study(OfStudy(study): OfStudy) -> Result<Json<Value>, Problem> {
    let edition = study.edition();
    let design = &edition.design;
    let all = study.people().all(&edition.hash).await?;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let people = || all.iter().filter(|seen| !seen.session.is_test() && !seen.session.is_simulated());
    people().for_each(|seen| *counts.entry(seen.session.status().word()).or_default() += 1);
    let finished = people().filter(|seen| seen.session.status() == Status::Completed).count();
    Ok(Json(json!({
        "name": design.name,
        "title": design.title.read(design.first_language(), design.first_language()),
        "hash": edition.hash,
        "text": design.text,
        "languages": design.languages,
        "contact": design.contact,
        "planned": design.planned_participants,
        "finished": finished,
        "counts": counts,
        "tests": all.iter().filter(|seen| seen.session.is_test()).count(),
        "simulated": all.iter().filter(|seen| seen.session.is_simulated()).count(),
        "rows": in_words(design),
        "conditions": conditions(design),
        "order": design.order,
        "primary": { "measure": design.primary.measure, "hypothesis": design.primary.hypothesis },
        "cells": in_cells(design, &all),
        "open_link": design.has_open_link().then(|| format!("{}/join", study.address())),
        "address": study.address(),
        "cohelm": env!("CARGO_PKG_VERSION"),
        "server_ms": now_ms(),
    })))
}

/// The design as pairs of a name and what it is.
fn in_words(design: &Design) -> Vec<(String, String)> {
    let sentences = explain(design, None).sentences;
    let mut rows: Vec<(String, String)> = TOPICS.map(String::from).into_iter().zip(sentences).collect();
    rows.extend(design.conditions.iter().map(|condition| {
        let (practice, measured) = (condition.practice_episodes, condition.measured_episodes);
        let asked = match condition.questionnaires.as_slice() {
            [] => String::new(),
            asked => format!(", then {}", asked.join(", ")),
        };
        let learning = if condition.learning { ", learning" } else { "" };
        let words = format!(
            "rule {}{learning}; flights: {practice} practice, {measured} measured{asked}",
            condition.rule.word()
        );
        (format!("Condition {}", condition.name), words)
    }));
    rows
}

fn conditions(design: &Design) -> Vec<Value> {
    let about = |condition: &cohelm_study::design::Condition| {
        json!({
            "name": condition.name,
            "rule": condition.rule,
            "inference": condition.inference,
            "silence": condition.silence,
            "learning": condition.learning,
            "practice": condition.practice_episodes,
            "measured": condition.measured_episodes,
            "questionnaires": condition.questionnaires,
        })
    };
    design.conditions.iter().map(about).collect()
}

/// Each order, with who finished it and who is at it. People only; simulated participants have counts of their own.
fn in_cells(design: &Design, all: &[Seen]) -> Vec<Value> {
    let heard_of = |seen: &Seen| seen.row.seen_at_ms.unwrap_or(seen.row.created_at_ms);
    let of = |simulated| {
        let people = all.iter().map(|seen| (seen.session.as_ref(), heard_of(seen)));
        tallies(design, people, now_ms(), simulated)
    };
    let (people, simulated) = (of(false), of(true));
    let name = |&index: &usize| design.conditions[index].name.as_str();
    let (all_planned, orders) = (design.planned_participants as usize, cells(design).len().max(1));
    let planned = |cell: usize| all_planned / orders + usize::from(cell < all_planned % orders);
    let about = |(cell, order): (usize, Vec<usize>)| {
        json!({
            "cell": cell,
            "order": order.iter().map(name).collect::<Vec<_>>(),
            "planned": planned(cell),
            "finished": people[cell].finished,
            "in_progress": people[cell].in_progress,
            "simulated_finished": simulated[cell].finished,
        })
    };
    cells(design).into_iter().enumerate().map(about).collect()
}

/// All participants of this version of the file.
pub async fn participants(OfStudy(study): OfStudy) -> Result<Json<Value>, Problem> {
    let all = study.people().all(&study.edition().hash).await?;
    let rows: Vec<Row> = all.iter().map(|seen| Row::of(&study, seen)).collect();
    Ok(Json(json!({ "participants": rows, "server_ms": now_ms() })))
}

/// A new participant.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct New {
    #[serde(default)]
    test: bool,
    #[serde(default)]
    simulated: bool,
    language: Option<String>,
    note: Option<String>,
}

/// Makes a participant; the link is shown this once.
pub async fn add(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Json(new): Json<New>,
) -> Result<(StatusCode, Json<Value>), Problem> {
    let languages = &study.edition().design.languages;
    if new.language.as_ref().is_some_and(|language| !languages.contains(language)) {
        let words = format!("the study speaks {}", languages.join(", "));
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words));
    }
    let note = new.note.map(words).transpose()?.filter(|note| !note.is_empty());
    let New { test, simulated, language, .. } = new;
    let invited = Event::Invited { test, simulated, language, panel: BTreeMap::new(), note };
    let (id, code, token) = invite(&server, &study, invited).await?;
    let link = link_of(&study, token.text());
    Ok((StatusCode::CREATED, Json(json!({ "id": id, "code": code, "link": link }))))
}

/// A new link, which voids the old one.
pub async fn new_link(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Path(id): Path<ParticipantId>,
) -> Result<Json<Value>, Problem> {
    let met = study.people().meet(id).await?;
    if met.session.status() == Status::Withdrawn {
        return Err(Problem::new(StatusCode::CONFLICT, "this participant has withdrawn"));
    }
    let code = met.row.code.clone();
    drop(met);
    let token = relink(&server, &study, id).await?;
    Ok(Json(json!({ "id": id, "code": code, "link": link_of(&study, token.text()) })))
}

fn link_of(study: &Study, token: &str) -> String {
    format!("{}/p/{token}", study.address())
}

/// What to say with it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Said {
    #[serde(default, alias = "text")]
    reason: String,
}

/// Leaves a participant out, takes them in again, deletes their data, or notes something.
pub async fn decide(
    OfStudy(study): OfStudy,
    Path((id, what)): Path<(ParticipantId, String)>,
    Json(Said { reason }): Json<Said>,
) -> Result<Json<Value>, Problem> {
    let said = words(reason)?;
    let met = study.people().meet(id).await?;
    let status = met.session.status();
    let conflict = |words: &str| Err(Problem::new(StatusCode::CONFLICT, words));
    if status == Status::Withdrawn {
        return conflict("this participant has withdrawn; nothing is left of them");
    }
    let by = BY.to_owned();
    let event = match what.as_str() {
        "exclude" | "note" if said.is_empty() => {
            return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "say why, in `reason`"));
        }
        "exclude" if status == Status::Excluded => return conflict("this participant is excluded already"),
        "exclude" => Event::Excluded { reason: said, by },
        "reinstate" if status != Status::Excluded => return conflict("this participant is not excluded"),
        "reinstate" => Event::Reinstated { by },
        "note" => Event::Note { text: said, by },
        "withdraw" => {
            erase(&study, met, BY).await?;
            return Ok(Json(json!({ "id": id, "status": Status::Withdrawn })));
        }
        _ => {
            return Err(Problem::not_found(
                "what can be done is exclude, reinstate, withdraw, note and link",
            ));
        }
    };
    let (met, _) = study.people().write(met, Vec::new(), vec![event]).await?;
    Ok(Json(json!({ "id": id, "status": met.session.status() })))
}

/// Trimmed, and not too many.
fn words(said: String) -> Result<String, Problem> {
    if said.chars().count() > MAX_WORDS {
        let words = format!("a note has at most {MAX_WORDS} characters");
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, words));
    }
    Ok(said.trim().to_owned())
}

/// Everything that happened to a participant.
pub async fn log(OfStudy(study): OfStudy, Path(id): Path<ParticipantId>) -> Result<Json<Value>, Problem> {
    let met = study.people().meet(id).await?;
    Ok(Json(json!({ "id": id, "code": met.row.code, "events": met.log })))
}

/// Which flights.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Which {
    participant: Option<ParticipantId>,
    before: Option<i64>,
    limit: Option<u32>,
}

/// Flights, the newest first, with their steps and conditions; of one participant if one is named. `next` is what to
/// ask for as `before`.
pub async fn episodes(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Query(Which { participant, before, limit }): Query<Which>,
) -> Result<Json<Value>, Problem> {
    let limit = limit.unwrap_or(USUAL_LIMIT).clamp(1, MOST_LIMIT);
    let paused = |error| Problem::paused(&error);
    let before = before.map(EpisodeId);
    // One more than asked for tells whether others follow.
    let mut rows = match participant {
        Some(id) => {
            drop(study.people().meet(id).await?);
            let trials = server.store().trials(id).await.map_err(paused)?;
            let wanted = trials.into_iter().rev().filter(|row| before.is_none_or(|before| row.id < before));
            wanted.take(limit as usize + 1).collect()
        }
        None => server.store().episodes(Page { before, limit: limit + 1 }).await.map_err(paused)?,
    };
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let next = if more { rows.last().map(|row| row.id) } else { None };
    let people: HashMap<_, _> = study
        .people()
        .all(&study.edition().hash)
        .await?
        .into_iter()
        .map(|seen| (seen.row.id, seen))
        .collect();
    let rows: Vec<Value> = rows.iter().map(|row| about(row, &people)).collect();
    Ok(Json(json!({ "episodes": rows, "next": next })))
}

fn about(episode: &Episode, people: &HashMap<ParticipantId, Seen>) -> Value {
    let mut about = json!(episode);
    let trial = episode.trial.as_ref();
    let seen = trial.and_then(|trial| people.get(&trial.participant));
    about["participant"] = json!(trial.map(|trial| trial.participant));
    about["code"] = json!(seen.map(|seen| &seen.row.code));
    about["step"] = json!(trial.map(|trial| &trial.step));
    about["condition"] = json!(trial.zip(seen).and_then(|(trial, seen)| condition_name(seen, &trial.step)));
    about
}

/// Word of every change, as server-sent events: `{"participants":[…], "all": false}`, ids only.
pub async fn news(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
) -> Sse<impl Stream<Item = Result<NewsEvent, Infallible>>> {
    let closing = server.closing().clone();
    let first = (study.hub().news(), true);
    let changes = stream::unfold(first, move |(mut news, is_first)| {
        let closing = closing.clone();
        async move {
            if is_first {
                // So that the answer begins, and the page knows that it listens.
                return Some((Ok(NewsEvent::default().comment("news follow")), (news, false)));
            }
            tokio::time::sleep(NEWS_EVERY).await;
            let changed = tokio::select! {
                changed = news.next() => changed?,
                () = closing.cancelled() => return None,
            };
            let event = NewsEvent::default().data(json!(changed).to_string());
            Some((Ok(event), (news, false)))
        }
    });
    Sse::new(changes).keep_alive(KeepAlive::default())
}
