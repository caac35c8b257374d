//! The SQL, in the words that SQLite and PostgreSQL share: `$n` placeholders, BIGINT numbers, no booleans.

/// The columns of an [`Episode`](super::Episode), in the order in which rows are read.
macro_rules! select_episodes {
    ($rest:literal) => {
        concat!(
            "SELECT id, plant, plant_version, format, program, rule, seed, pilot, time_scale, values_model, ",
            "intent_model, setup, started_at_ms, ended_at_ms, ticks, ending, refused FROM episodes ",
            $rest
        )
    };
}

pub const EPISODES_BEFORE: &str = select_episodes!("WHERE id < $1 ORDER BY id DESC LIMIT $2");
pub const EPISODE: &str = select_episodes!("WHERE id = $1");
pub const EPISODE_OF_KEY: &str = select_episodes!("WHERE flight_key = $1");
pub const RECORD: &str = "SELECT bytes FROM records WHERE episode = $1";
pub const CHUNKS: &str = "SELECT from_tick, to_tick, plant_digest, decisions_digest, events FROM chunks \
    WHERE episode = $1 ORDER BY from_tick";
pub const MODELS: &str = "SELECT hash, origin, kind, name, plant, card, stored_at_ms, kept_at_ms FROM models \
    ORDER BY stored_at_ms, hash";
pub const MODEL: &str = "SELECT bytes FROM models WHERE hash = $1";
pub const CHECK: &str = "SELECT COUNT(*) FROM episodes WHERE id = 0";

pub const ADD_MODEL: &str = "INSERT INTO models (hash, origin, kind, name, plant, card, bytes, stored_at_ms) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8) ON CONFLICT (hash) DO NOTHING";
pub const KEEP_NONE: &str = "UPDATE models SET kept_at_ms = NULL WHERE plant = $1";
pub const KEEP: &str = "UPDATE models SET kept_at_ms = $2 WHERE hash = $1";
pub const ADD_EPISODE: &str = "INSERT INTO episodes (flight_key, plant, plant_version, format, program, rule, seed, \
    pilot, time_scale, values_model, intent_model, setup, started_at_ms, ended_at_ms, ticks, ending) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16) RETURNING id";
pub const ADVANCE: &str = "UPDATE episodes SET ticks = $3 \
    WHERE id = $1 AND ticks = $2 AND ending IS NULL AND refused IS NULL";
pub const ADD_CHUNK: &str = "INSERT INTO chunks (episode, from_tick, to_tick, plant_digest, decisions_digest, events) \
    VALUES ($1, $2, $3, $4, $5, $6)";
pub const FINISH: &str = "UPDATE episodes SET ending = $2, ticks = $3, ended_at_ms = $4 \
    WHERE id = $1 AND ending IS NULL AND refused IS NULL";
pub const ADD_RECORD: &str = "INSERT INTO records (episode, bytes) VALUES ($1, $2)";
pub const DROP_CHUNKS: &str = "DELETE FROM chunks WHERE episode = $1";
pub const REFUSE: &str = "UPDATE episodes SET refused = $2, ended_at_ms = $3 \
    WHERE id = $1 AND ending IS NULL AND refused IS NULL";
pub const FORGET: &str =
    "DELETE FROM episodes WHERE id = $1 AND ticks = 0 AND ending IS NULL AND refused IS NULL";
