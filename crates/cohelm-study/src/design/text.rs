//! A text that participants read: the same in every language, or one for each.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A text, or the same text in several languages.
///
/// ```
/// use cohelm_study::design::Words;
/// let hello: Words = serde_json::from_str(r#"{"en": "Hello", "de": "Hallo"}"#)?;
/// assert_eq!(hello.read("de", "en"), "Hallo");
/// assert_eq!(hello.read("fr", "en"), "Hello", "what is not translated is read in the first language");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Words {
    /// Read so in every language.
    Same(String),
    /// By code of language.
    By(BTreeMap<String, String>),
}

impl Words {
    /// The text in a language; what is not translated is read in the `first` language, or else in English, or else in
    /// whichever there is.
    pub fn read(&self, language: &str, first: &str) -> &str {
        match self {
            Self::Same(text) => text,
            Self::By(texts) => {
                let preferred = [language, first, "en"].into_iter().find_map(|code| texts.get(code));
                preferred.or_else(|| texts.values().next()).map_or("", |text| text)
            }
        }
    }

    /// True if nothing is to be read in any language.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Same(text) => text.trim().is_empty(),
            Self::By(texts) => texts.values().all(|text| text.trim().is_empty()),
        }
    }

    /// The text in every language it is given in.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        let (one, several) = match self {
            Self::Same(text) => (Some(text), None),
            Self::By(texts) => (None, Some(texts.values())),
        };
        one.into_iter().chain(several.into_iter().flatten()).map(String::as_str)
    }

    /// Whether it can be read in a language without falling back to another.
    pub fn speaks(&self, language: &str) -> bool {
        match self {
            Self::Same(_) => true,
            Self::By(texts) => texts.get(language).is_some_and(|text| !text.trim().is_empty()),
        }
    }
}

impl Default for Words {
    fn default() -> Self {
        Self::Same(String::new())
    }
}

impl From<&str> for Words {
    fn from(text: &str) -> Self {
        Self::Same(text.to_owned())
    }
}

impl<'de> Deserialize<'de> for Words {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WordsVisitor)
    }
}

struct WordsVisitor;

impl<'de> Visitor<'de> for WordsVisitor {
    type Value = Words;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(
            "a text, or a table with one text for each language such as { en = \"…\", de = \"…\" }",
        )
    }

    fn visit_str<E>(self, text: &str) -> Result<Words, E> {
        Ok(Words::Same(text.to_owned()))
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Words, M::Error> {
        let mut texts = BTreeMap::new();
        while let Some((language, text)) = map.next_entry::<String, String>()? {
            texts.insert(language, text);
        }
        Ok(Words::By(texts))
    }
}

impl JsonSchema for Words {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Words".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A text, or a table with one text for each language: { en = \"…\", de = \"…\" }.",
            "anyOf": [
                { "type": "string" },
                { "type": "object", "additionalProperties": { "type": "string" } }
            ]
        })
    }
}

/// The schema of a checked type is that of the table in the file which it is read from.
macro_rules! described_by {
    ($checked:ident, $table:ident) => {
        impl schemars::JsonSchema for $checked {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($checked).into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                <$table as schemars::JsonSchema>::json_schema(generator)
            }
        }
    };
}
pub(crate) use described_by;
