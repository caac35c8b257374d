//! The SQL, in the words that SQLite and PostgreSQL share: `$n` placeholders, BIGINT numbers, no booleans.

/// The columns of an [`Episode`](super::Episode), in the order in which rows are read.
macro_rules! select_episodes {
    ($rest:literal) => {
        concat!(
            "SELECT id, plant, plant_version, format, program, rule, seed, pilot, time_scale, values_model, ",
            "intent_model, setup, started_at_ms, ended_at_ms, ticks, ending, refused, participant, step FROM episodes ",
            $rest
        )
    };
}

pub const EPISODES_BEFORE: &str = select_episodes!("WHERE id < $1 ORDER BY id DESC LIMIT $2");
pub const EPISODE: &str = select_episodes!("WHERE id = $1");
pub const TRIALS: &str = select_episodes!("WHERE participant = $1 ORDER BY id");
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
    pilot, time_scale, values_model, intent_model, setup, started_at_ms, ended_at_ms, ticks, ending, participant, step) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18) RETURNING id";
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

/// The columns of a [`Participant`](super::Participant), in the order in which rows are read.
macro_rules! select_participants {
    ($rest:literal) => {
        concat!(
            "SELECT id, study, code, created_at_ms, seen_at_ms, last_seq, withdrawn_at_ms FROM participants ",
            $rest
        )
    };
}

pub const STUDIES: &str = "SELECT hash, name, text, stored_at_ms FROM studies ORDER BY stored_at_ms, hash";
pub const STUDY: &str = "SELECT hash, name, text, stored_at_ms FROM studies WHERE hash = $1";
pub const PARTICIPANTS: &str = select_participants!("WHERE study = $1 ORDER BY id");
pub const PARTICIPANT: &str = select_participants!("WHERE id = $1");
pub const PARTICIPANT_OF_TOKEN: &str = select_participants!("WHERE token_hash = $1");
pub const LARGEST_PARTICIPANT: &str = "SELECT COALESCE(MAX(id), 0) FROM participants";
pub const ANY_WITHDRAWN: &str = "SELECT id FROM participants WHERE withdrawn_at_ms IS NOT NULL LIMIT 1";
pub const EVENTS: &str =
    "SELECT seq, at_ms, event FROM events WHERE participant = $1 AND seq > $2 ORDER BY seq";
pub const SETTING: &str = "SELECT value FROM settings WHERE name = $1";

pub const ADD_STUDY: &str = "INSERT INTO studies (hash, name, text, stored_at_ms) VALUES ($1, $2, $3, $4) \
    ON CONFLICT (hash) DO NOTHING";
pub const ADD_PARTICIPANT: &str = "INSERT INTO participants (id, study, code, token_hash, created_at_ms, last_seq) \
    VALUES ($1, $2, $3, $4, $5, 0)";
pub const LINK: &str = "UPDATE participants SET token_hash = $2 WHERE id = $1 AND withdrawn_at_ms IS NULL";
pub const SEEN: &str = "UPDATE participants SET seen_at_ms = $2 WHERE id = $1 AND withdrawn_at_ms IS NULL";
pub const ADVANCE_LOG: &str = "UPDATE participants SET last_seq = $2, seen_at_ms = $3 \
    WHERE id = $1 AND last_seq = $2 - 1 AND withdrawn_at_ms IS NULL";
pub const ADD_EVENT: &str = "INSERT INTO events (participant, seq, at_ms, event) VALUES ($1, $2, $3, $4)";
pub const WITHDRAW: &str = "UPDATE participants SET token_hash = NULL, seen_at_ms = NULL, last_seq = $2, \
    withdrawn_at_ms = $3 WHERE id = $1 AND withdrawn_at_ms IS NULL";
pub const DROP_EVENTS: &str = "DELETE FROM events WHERE participant = $1";
pub const DROP_TRIALS: &str = "DELETE FROM episodes WHERE participant = $1";
pub const SET: &str = "INSERT INTO settings (name, value) VALUES ($1, $2) \
    ON CONFLICT (name) DO UPDATE SET value = excluded.value";
