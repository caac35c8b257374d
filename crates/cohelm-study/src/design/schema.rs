//! The JSON Schema of a study's file, and the reference of its keys: both made from the types, so that neither is ever
//! out of date.

use super::Design;
use crate::questionnaires;
use serde_json::{Map, Value};

/// The JSON Schema of a study's file. Editors that know schemas (Even Better TOML and others) complete and check with it.
pub fn schema() -> Value {
    let settings = schemars::generate::SchemaSettings::draft2020_12();
    let mut schema = settings.into_generator().into_root_schema_for::<Design>().to_value();
    if let Value::Object(fields) = &mut schema {
        fields.insert("title".to_owned(), Value::from("A study of shared control, cohelm-study = 1"));
    }
    schema
}

/// Every key with its meaning, as Markdown: a table for each table of the file.
pub fn reference() -> String {
    let schema = schema();
    let mut text = String::new();
    section(&mut text, "The file", &schema, &schema);
    let empty = Map::new();
    let definitions = schema.get("$defs").and_then(Value::as_object).unwrap_or(&empty);
    for (name, heading) in TABLES {
        if let Some(definition) = definitions.get(name) {
            section(&mut text, heading, definition, &schema);
        }
    }
    text
}

/// The built-in questionnaires as a Markdown table.
pub fn instruments() -> String {
    let mut text = "| name | items | scores | source | terms |\n|---|---|---|---|---|\n".to_owned();
    for known in questionnaires::built_in() {
        let scores: Vec<String> = known.scores().iter().map(|score| format!("`{score}`")).collect();
        let said = |words: &Option<String>| one_line(words.as_deref().unwrap_or_default());
        let (items, scores) = (known.items.len(), scores.join(", "));
        text += &format!(
            "| `{}` | {items} | {scores} | {} | {} |\n",
            known.name,
            said(&known.source),
            said(&known.terms)
        );
    }
    text + "\n"
}

/// The tables of a file in the order of the reference: name of the type, heading.
const TABLES: [(&str, &str); 19] = [
    ("TaskPlan", "`[task]`"),
    ("Condition", "`[[conditions]]`"),
    ("Terrain", "`[terrain]`"),
    ("Consent", "`[consent]`"),
    ("Instructions", "`[instructions]`"),
    ("InstructionPage", "`[[instructions.pages]]`"),
    ("Item", "`[[demographics]]`, and `items` of questionnaires"),
    ("Quiz", "`[quiz]`"),
    ("QuizQuestion", "`[[quiz.questions]]`"),
    ("Breaks", "`[breaks]`"),
    ("Questionnaire", "`[[questionnaires]]`"),
    ("Attention", "`[attention]`"),
    ("AttentionCheck", "`[[attention.checks]]`"),
    ("ExclusionRules", "`[exclusion]`"),
    ("Primary", "`[primary]`"),
    ("Panel", "`[panel]`"),
    ("Timing", "`[timing]`"),
    ("Words", "Texts"),
    ("Choice", "Choices"),
];

fn section(text: &mut String, heading: &str, definition: &Value, root: &Value) {
    text.push_str(&format!("### {heading}\n\n"));
    if let Some(description) =
        definition.get("description").and_then(Value::as_str).filter(|_| heading != "The file")
    {
        text.push_str(&format!("{}\n\n", one_line(description)));
    }
    let Some(properties) = definition.get("properties").and_then(Value::as_object) else { return };
    let required: Vec<&str> = definition
        .get("required")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    text.push_str("| key | what it takes | meaning |\n|---|---|---|\n");
    let (needed, optional): (Vec<_>, Vec<_>) =
        properties.iter().partition(|(key, _)| required.contains(&key.as_str()));
    for (key, property) in needed.iter().chain(&optional) {
        let star = if required.contains(&key.as_str()) { " *" } else { "" };
        let meaning = property.get("description").and_then(Value::as_str).unwrap_or_default();
        let words = variants(property, root);
        text.push_str(&format!(
            "| `{key}`{star} | {} | {}{words} |\n",
            kind(property, root),
            one_line(meaning)
        ));
    }
    text.push('\n');
}

/// What a key takes, in a word or two.
fn kind(property: &Value, root: &Value) -> String {
    if let Some(name) = reference_of(property) {
        let definition = root.pointer(&format!("/$defs/{name}")).unwrap_or(&Value::Null);
        return match name {
            "Words" => "text".to_owned(),
            _ if choices(definition).is_some() => "word".to_owned(),
            _ => kind(definition, root),
        };
    }
    if let Some(alternatives) = property.get("anyOf").and_then(Value::as_array) {
        let mut words: Vec<String> = alternatives.iter().map(|alternative| kind(alternative, root)).collect();
        words.dedup();
        return words.join(" or ");
    }
    match type_of(property) {
        Some("array") => {
            let items = kind(property.get("items").unwrap_or(&Value::Null), root);
            format!("list of {}", items.split(" or ").map(plural).collect::<Vec<_>>().join(" or "))
        }
        Some(name) => word_of(name).to_owned(),
        None => "table".to_owned(),
    }
}

/// The JSON type; of an optional key the one besides null.
fn type_of(property: &Value) -> Option<&str> {
    match property.get("type")? {
        Value::String(name) => Some(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).find(|name| *name != "null"),
        _ => None,
    }
}

fn word_of(json_type: &str) -> &str {
    match json_type {
        "string" => "text",
        "integer" => "whole number",
        "number" => "number",
        "boolean" => "true or false",
        "object" => "table",
        other => other,
    }
}

fn plural(word: &str) -> String {
    match word {
        "true or false" => word.to_owned(),
        _ => format!("{word}s"),
    }
}

/// The words that an enumeration takes, each with its meaning.
fn variants(property: &Value, root: &Value) -> String {
    let Some(definition) = reference_of(property).and_then(|name| root.pointer(&format!("/$defs/{name}")))
    else {
        return String::new();
    };
    let Some(choices) = choices(definition) else { return String::new() };
    let words = choices.iter().filter_map(|choice| {
        let word = choice.get("const")?.as_str()?;
        let meaning = choice.get("description").and_then(Value::as_str).unwrap_or_default();
        Some(format!("<br>`{word}`: {}", one_line(meaning)))
    });
    words.collect()
}

fn choices(definition: &Value) -> Option<&Vec<Value>> {
    let choices = definition.get("oneOf")?.as_array()?;
    choices.iter().all(|choice| choice.get("const").is_some()).then_some(choices)
}

/// The name of the definition that a property refers to, be it optional or not.
fn reference_of(property: &Value) -> Option<&str> {
    let direct = property.get("$ref").and_then(Value::as_str);
    let in_any = || property.get("anyOf")?.as_array()?.iter().find_map(|one| one.get("$ref")?.as_str());
    direct.or_else(in_any)?.strip_prefix("#/$defs/")
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn file(name: &str) -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
    }

    /// `UPDATE_SCHEMA=1 cargo test -p cohelm-study schema` writes both files anew.
    fn hold(name: &str, expected: &str) {
        let path = file(name);
        if std::env::var_os("UPDATE_SCHEMA").is_some() {
            std::fs::write(&path, expected).expect("the file can be written");
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            found == expected,
            "{name} is out of date: run `UPDATE_SCHEMA=1 cargo test -p cohelm-study schema`"
        );
    }

    #[test]
    fn the_schema_in_the_repository_is_that_of_the_types() {
        let text = serde_json::to_string_pretty(&schema()).expect("a schema is JSON") + "\n";
        hold("studies/study.schema.json", &text);
    }

    /// The part of a text between two marks, replaced.
    fn with_part(text: &str, name: &str, part: &str) -> String {
        let begin = format!("<!-- {name}: written by a test of cohelm-study -->\n");
        let end = format!("<!-- end of {name} -->");
        let (before, rest) = text.split_once(&begin).expect("the part has its place");
        let (_, after) = rest.split_once(&end).expect("the part has its end");
        format!("{before}{begin}\n{part}{end}{after}")
    }

    #[test]
    fn the_reference_in_the_documentation_is_that_of_the_types() {
        let text = std::fs::read_to_string(file("docs/study.md")).expect("shipped with the project");
        let text = with_part(&text, "instruments", &instruments());
        hold("docs/study.md", &with_part(&text, "reference", &reference()));
    }

    /// The first example is a whole file; the others are parts that go with it.
    #[test]
    fn the_examples_in_the_documentation_are_studies() {
        let text = std::fs::read_to_string(file("docs/study.md")).expect("shipped with the project");
        let blocks = text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
        let examples: Vec<&str> = blocks.filter(|block| !block.starts_with("#:schema")).collect();
        let (whole, parts) = examples.split_first().expect("there are examples");
        for example in [String::new()].into_iter().chain(parts.iter().map(|part| format!("\n{part}"))) {
            Design::from_toml(&format!("{whole}{example}"))
                .unwrap_or_else(|error| panic!("{example}\n{error}"));
        }
        assert!(examples.len() >= 3, "{}", examples.len());
    }

    #[test]
    fn every_key_is_explained() {
        let schema = schema();
        let definitions = schema["$defs"].as_object().expect("there are definitions");
        let tables =
            definitions.values().chain([&schema]).filter_map(|table| table.get("properties")?.as_object());
        for (key, property) in tables.flatten() {
            assert!(property.get("description").is_some(), "{key} has no description");
        }
        for (name, _) in TABLES {
            assert!(definitions.contains_key(name), "{name} is no table of the schema");
        }
    }
}
