-- Episodes that people and simulated pilots fly, and the models that assisted them.
-- Times are milliseconds since 1970 UTC by the server's clock; nothing depends on their order.

-- Every model that ever flew or was offered, once, under the SHA-256 of its bytes.
CREATE TABLE models (
    hash         TEXT PRIMARY KEY NOT NULL,
    origin       TEXT NOT NULL,    -- shipped | given | learned
    kind         TEXT NOT NULL,    -- values | intent
    name         TEXT NOT NULL,
    plant        TEXT NOT NULL,
    card         TEXT NOT NULL,    -- JSON
    bytes        BLOB NOT NULL,
    stored_at_ms BIGINT NOT NULL,
    kept_at_ms   BIGINT            -- when a person chose to go on from it; NULL: never, or not any more
);

-- One row an episode, from its first moment. It is in the air while `ending` and `refused` are both NULL.
CREATE TABLE episodes (
    id             INTEGER PRIMARY KEY AUTOINCREMENT,   -- never given twice
    flight_key     BLOB UNIQUE,      -- 16 bytes that the page chose, to find its flight again; NULL if simulated
    plant          TEXT NOT NULL,
    plant_version  BIGINT NOT NULL,
    format         BIGINT NOT NULL,  -- of the record
    program        TEXT NOT NULL,    -- version of cohelm that wrote it
    rule           TEXT NOT NULL,
    seed           BIGINT NOT NULL,
    pilot          TEXT NOT NULL,
    time_scale     DOUBLE PRECISION NOT NULL,
    values_model   TEXT REFERENCES models (hash),
    intent_model   TEXT REFERENCES models (hash),
    setup          TEXT NOT NULL,    -- JSON; the columns above repeat parts of it
    started_at_ms  BIGINT NOT NULL,
    ended_at_ms    BIGINT,
    ticks          BIGINT NOT NULL,  -- followed and committed so far
    ending         TEXT,
    refused        TEXT              -- why the server would not believe the log
);

-- The record of a finished episode, zstd; apart from `episodes`, so that listing reads no blob.
CREATE TABLE records (
    episode BIGINT PRIMARY KEY NOT NULL REFERENCES episodes (id) ON DELETE CASCADE,
    bytes   BLOB NOT NULL
);

-- The key log of an episode in the air, piece by piece; the end of the episode merges them into its record. Those of a
-- refused episode stay, as evidence.
CREATE TABLE chunks (
    episode          BIGINT NOT NULL REFERENCES episodes (id) ON DELETE CASCADE,
    from_tick        BIGINT NOT NULL,
    to_tick          BIGINT NOT NULL,
    plant_digest     BIGINT NOT NULL,  -- after to_tick ticks; the 64 bits as a signed number
    decisions_digest BIGINT NOT NULL,
    events           BLOB NOT NULL,
    PRIMARY KEY (episode, from_tick)
);
