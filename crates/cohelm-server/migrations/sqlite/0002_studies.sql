-- Studies, who takes part in them, and what happened to whom.

-- Every version of a study's file that was ever run, once, under the SHA-256 of its bytes.
CREATE TABLE studies (
    hash         TEXT PRIMARY KEY NOT NULL,
    name         TEXT NOT NULL,
    text         TEXT NOT NULL,    -- the file
    stored_at_ms BIGINT NOT NULL
);

-- One row a participant. One who withdrew leaves it behind, without link and without flights.
CREATE TABLE participants (
    id              BIGINT PRIMARY KEY NOT NULL,   -- counts up from 1, never given twice
    study           TEXT NOT NULL REFERENCES studies (hash),
    code            TEXT NOT NULL UNIQUE,          -- short, shown to people
    token_hash      BLOB UNIQUE,                   -- SHA-256 of the link's secret; NULL: there is no link
    created_at_ms   BIGINT NOT NULL,
    seen_at_ms      BIGINT,                        -- when the page was last heard of
    last_seq        BIGINT NOT NULL,               -- number of the newest event, 0 if there is none
    withdrawn_at_ms BIGINT
);
CREATE INDEX participants_of_study ON participants (study);

-- What happened to a participant, in order; only ever added to.
CREATE TABLE events (
    participant BIGINT NOT NULL REFERENCES participants (id),
    seq         BIGINT NOT NULL,                   -- 1, 2, ... without a gap
    at_ms       BIGINT NOT NULL,
    event       TEXT NOT NULL,                     -- JSON
    PRIMARY KEY (participant, seq)
);

-- What the program has to remember of itself, such as the hash of the researcher's secret.
CREATE TABLE settings (
    name  TEXT PRIMARY KEY NOT NULL,
    value TEXT NOT NULL
);

-- Flights within a study: whose, and which step of the session. Both NULL outside of studies.
ALTER TABLE episodes ADD COLUMN participant BIGINT REFERENCES participants (id);
ALTER TABLE episodes ADD COLUMN step TEXT;
CREATE INDEX episodes_of_participant ON episodes (participant) WHERE participant IS NOT NULL;
