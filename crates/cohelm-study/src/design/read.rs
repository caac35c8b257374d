//! From a study's file to a design, or to what is wrong with it, where, and what was meant perhaps.

use super::{Catalogue, Design, DesignError, PlantFacts, Problem, check, condition};
use toml::de::{DeTable, DeValue};

/// Reads and checks a study's file.
pub(super) fn read(text: &str) -> Result<Design, DesignError> {
    let mut design: Design = toml::from_str(text).map_err(|error| match condition::rule_faults(text) {
        faults if faults.is_empty() => unreadable(text, &error),
        faults => located(text, faults),
    })?;
    design.text = text.to_owned();
    let complaints = check::complaints(&design);
    if complaints.is_empty() { Ok(design) } else { Err(located(text, complaints)) }
}

/// Asks whoever knows plants and models.
pub(super) fn check_with(design: &Design, catalogue: &dyn Catalogue) -> Result<PlantFacts, DesignError> {
    let facts = catalogue
        .check_task(&design.task.task)
        .map_err(|reason| located(&design.text, vec![("task.plant".to_owned(), reason)]))?;
    let conditions = design.conditions.iter().enumerate();
    let complaints: Vec<_> = conditions
        .filter_map(|(index, condition)| {
            let reason = catalogue.check_condition(design, condition).err()?;
            Some((format!("conditions[{index}].rule"), reason))
        })
        .collect();
    if complaints.is_empty() { Ok(facts) } else { Err(located(&design.text, complaints)) }
}

/// Complaints in the order of the file.
fn located(text: &str, complaints: Vec<(String, String)>) -> DesignError {
    let problem = |(path, message): (String, String)| Problem {
        at: place_of(text, &path),
        message: format!("{path}: {message}"),
    };
    let mut problems: Vec<Problem> = complaints.into_iter().map(problem).collect();
    problems.sort_by_key(|problem| problem.at);
    DesignError { problems }
}

fn unreadable(text: &str, error: &toml::de::Error) -> DesignError {
    let at = error.span().map(|span| line_and_column(text, span.start));
    let message = error.message().trim_end();
    let message = suggestion(message).unwrap_or_else(|| plain(message));
    DesignError { problems: vec![Problem { at, message }] }
}

/// "unknown field `a`, expected one of `b`, `c`" with the nearest of what was expected, the others behind it.
fn suggestion(message: &str) -> Option<String> {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (got, expected) = quoted.split_first()?;
    let word = match message {
        _ if message.starts_with("unknown field") => "key",
        _ if message.starts_with("unknown variant") => "value",
        _ => return None,
    };
    let known = expected.join(", ");
    Some(match nearest(got, expected) {
        Some(near) => format!("unknown {word} `{got}`; did you mean `{near}`? Known here: {known}"),
        None => format!("unknown {word} `{got}`. Known here: {known}"),
    })
}

/// A reader's message in the words of somebody who writes no Rust.
fn plain(message: &str) -> String {
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("the key {key} is missing here");
    }
    let rest = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
    let Some((got, expected)) = rest.and_then(|rest| rest.split_once(", expected ")) else {
        return message.to_owned();
    };
    let expected = match expected {
        "u32" => "a whole number from 0 to 4294967295",
        "u64" => "a whole number of 0 or more",
        "f64" => "a number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "a sequence" => "a list in brackets",
        other => other,
    };
    format!("expected {expected}, got {got}")
}

/// The word that is fewest changes away, of those that are near at all: a third of the letters may differ, or one word
/// holds the other.
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let most = word.chars().count().max(3) / 3 + 1;
    let is_near = |candidate: &str, changes: usize| {
        let holds =
            word.len() >= 3 && candidate.len() >= 3 && (candidate.contains(word) || word.contains(candidate));
        changes <= most || holds
    };
    let counted = known.iter().map(|candidate| (changes(word, candidate), *candidate));
    counted.filter(|(changes, candidate)| is_near(candidate, *changes)).min().map(|(_, near)| near)
}

/// How many letters to put in, take out, replace or swap with their neighbour lead from one word to the other.
fn changes(from: &str, to: &str) -> usize {
    let (from, to): (Vec<char>, Vec<char>) = (from.chars().collect(), to.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=to.len()).collect()];
    for i in 1..=from.len() {
        let mut row = vec![i];
        for j in 1..=to.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(from[i - 1] != to[j - 1]);
            let mut least = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[from.len()][to.len()]
}

/// Where a path such as `conditions[1].rule` stands in the file; where its table stands, if the key is not there.
fn place_of(text: &str, path: &str) -> Option<(usize, usize)> {
    let table = DeTable::parse(text).ok()?;
    let mut at = table.span().start;
    let mut value = DeValue::Table(table.into_inner());
    for part in path.split('.') {
        let (key, index) = part.split_once('[').map_or((part, None), |(key, rest)| (key, Some(rest)));
        let DeValue::Table(mut fields) = value else { break };
        let Some((name, inner)) = fields.remove_entry(key) else { break };
        at = name.span().start;
        value = inner.into_inner();
        let Some(index) = index.and_then(|rest| rest.trim_end_matches(']').parse::<usize>().ok()) else {
            continue;
        };
        let DeValue::Array(items) = value else { break };
        let Some(item) = items.into_iter().nth(index) else { break };
        at = item.span().start;
        value = item.into_inner();
    }
    Some(line_and_column(text, at))
}

/// Line and column of a byte, both from 1; columns count characters.
fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte.min(text.len())).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_key_is_the_fewest_changes_away() {
        let known = ["conditions", "consent", "contact", "practice-episodes", "measured-episodes"];
        assert_eq!(nearest("contidions", &known), Some("conditions"));
        assert_eq!(nearest("practice_episodes", &known), Some("practice-episodes"));
        assert_eq!(nearest("episodes", &known), Some("measured-episodes"), "one holds the other");
        assert_eq!(nearest("zebra", &known), None);
    }

    #[test]
    fn swapped_neighbours_are_one_change() {
        assert_eq!(changes("ordre", "order"), 1);
        assert_eq!(changes("", "abc"), 3);
        assert_eq!(changes("kitten", "sitting"), 3);
    }

    #[test]
    fn columns_count_characters_not_bytes() {
        assert_eq!(line_and_column("a = 1\nä = 2\n", "a = 1\nä = ".len()), (2, 5));
        assert_eq!(line_and_column("", 10), (1, 1));
    }
}
