//! What can be asked for: lists as JSON, models and records as their bytes.

use super::problem::Problem;
use crate::hangar::is_hash;
use crate::learn::Learning;
use crate::page::{answer_cached, etag};
use crate::server::Server;
use crate::store::{EpisodeId, Page, StoredModel, unpack};
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::Response;
use cohelm::keys::controls;
use cohelm::registry::Task;
use cohelm_copilot::Model;
use serde::Deserialize;
use serde_json::{Value, json};

/// Episodes of a list unless another number is asked for, and at most.
const USUAL_LIMIT: u32 = 50;
const MOST_LIMIT: u32 = 1_000;
/// For what never changes under its address.
const FOREVER: &str = "private, max-age=31536000, immutable";

pub async fn health(State(server): State<Server>) -> Result<Json<Value>, Problem> {
    match server.store().check().await {
        Ok(()) => Ok(Json(json!({ "status": "ok", "cohelm": env!("CARGO_PKG_VERSION") }))),
        Err(error) => Err(Problem::new(StatusCode::SERVICE_UNAVAILABLE, error.to_string())),
    }
}

/// The plants, each as it is with its default options.
pub async fn plants(State(server): State<Server>) -> Json<Value> {
    let plants = server.hangar().plants();
    let described = plants.entries().iter().map(|entry| {
        let mut about = json!({ "name": entry.name, "version": entry.version, "summary": entry.summary });
        about["hand_made_values"] = entry.values.is_some().into();
        if let Ok(plant) = plants.make(&Task::new(entry.name)) {
            about["ticks_per_second"] = plant.ticks_per_second().into();
            about["space"] = json!(plant.space());
            about["controls"] = json!(controls(plant.space()));
        }
        about
    });
    Json(json!({ "plants": described.collect::<Vec<_>>() }))
}

/// All models that were ever stored. `offered` are those that came with this program; `usual` is the one of these to
/// take for a plant and its actions unless another is wanted.
pub async fn models(State(server): State<Server>) -> Result<Json<Value>, Problem> {
    let offered = server.hangar().models();
    let describe = |model: StoredModel| {
        let known = offered.get(&model.hash).map(Model::card);
        let usual = known.and_then(|card| offered.newest_for(card.kind, &card.task, &card.space));
        let mut about = json!(model);
        about["offered"] = known.is_some().into();
        about["usual"] = usual.is_some_and(|usual| usual.hash() == model.hash).into();
        about
    };
    let models: Vec<Value> = server.store().models().await?.into_iter().map(describe).collect();
    Ok(Json(json!({ "models": models })))
}

pub async fn model(
    State(server): State<Server>,
    Path(hash): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let unknown = || Problem::not_found("there is no model of this hash");
    if !is_hash(&hash) {
        return Err(unknown());
    }
    let bytes = server.store().model(&hash).await?.ok_or_else(unknown)?;
    let mut response = answer_cached(&headers, &etag(&bytes), FOREVER, "application/octet-stream", bytes);
    attach(&mut response, &format!("{hash}.safetensors"));
    Ok(response)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    before: Option<i64>,
    limit: Option<u32>,
}

/// A part of the list of episodes; `next` is what to ask for as `before`.
pub async fn episodes(
    State(server): State<Server>,
    Query(part): Query<Part>,
) -> Result<Json<Value>, Problem> {
    let limit = part.limit.unwrap_or(USUAL_LIMIT).clamp(1, MOST_LIMIT);
    // One more than asked for tells whether others follow.
    let page = Page { before: part.before.map(EpisodeId), limit: limit + 1 };
    let mut episodes = server.store().episodes(page).await?;
    let more = episodes.len() > limit as usize;
    episodes.truncate(limit as usize);
    let next = if more { episodes.last().map(|episode| episode.id) } else { None };
    Ok(Json(json!({ "episodes": episodes, "next": next })))
}

/// The record of a finished episode.
pub async fn episode(
    State(server): State<Server>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let unknown = || Problem::not_found("there is no episode of this number");
    let id = EpisodeId(id.parse().map_err(|_| unknown())?);
    let Some(packed) = server.store().record(id).await? else {
        server.store().episode(id).await?.ok_or_else(unknown)?;
        let words = "this episode has no record: it is still in the air, was interrupted, or was refused";
        return Err(Problem::new(StatusCode::CONFLICT, words));
    };
    let bytes = unpack(&packed)?;
    let mut response = answer_cached(&headers, &etag(&bytes), FOREVER, "application/octet-stream", bytes);
    attach(&mut response, &format!("episode-{id}.cohelm"));
    Ok(response)
}

fn attach(response: &mut Response, name: &str) {
    if let Ok(value) = HeaderValue::try_from(format!("attachment; filename=\"{name}\"")) {
        response.headers_mut().insert(header::CONTENT_DISPOSITION, value);
    }
}

pub async fn learning(State(server): State<Server>) -> Json<Value> {
    Json(match server.learning() {
        Some(learning) => with_learning(json!(learning.status())),
        None => json!({ "learning": false }),
    })
}

pub async fn keep(State(server): State<Server>) -> Result<Json<Value>, Problem> {
    let status = learner(&server)?.keep_current().await?;
    Ok(Json(with_learning(json!(status))))
}

pub async fn reset(State(server): State<Server>) -> Result<Json<Value>, Problem> {
    let status = learner(&server)?.return_to_shipped().await?;
    Ok(Json(with_learning(json!(status))))
}

fn learner(server: &Server) -> Result<&Learning, Problem> {
    let words = "nothing learns here; start with cohelm fly --learn";
    server.learning().ok_or_else(|| Problem::new(StatusCode::CONFLICT, words))
}

fn with_learning(mut status: Value) -> Value {
    status["learning"] = true.into();
    status
}
