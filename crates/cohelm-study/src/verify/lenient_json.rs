//! JSON as Python writes it: `NaN`, `Infinity` and `-Infinity` are allowed outside strings and become `null`.

use std::borrow::Cow;

/// Replaces Python's names of non-finite numbers by `null`; everything else is left as it is.
pub(super) fn without_non_finite(text: &[u8]) -> Cow<'_, [u8]> {
    const NAMES: [&[u8]; 3] = [b"-Infinity", b"Infinity", b"NaN"];
    let mut out: Option<Vec<u8>> = None;
    let (mut at, mut copied, mut in_string) = (0, 0, false);
    while at < text.len() {
        match text[at] {
            b'\\' if in_string => at += 1,
            b'"' => in_string = !in_string,
            _ if in_string => {}
            _ => {
                if let Some(name) = NAMES.iter().find(|name| text[at..].starts_with(name)) {
                    let out = out.get_or_insert_default();
                    out.extend_from_slice(&text[copied..at]);
                    out.extend_from_slice(b"null");
                    at += name.len();
                    copied = at;
                    continue;
                }
            }
        }
        at += 1;
    }
    match out {
        None => Cow::Borrowed(text),
        Some(mut out) => {
            out.extend_from_slice(&text[copied..]);
            Cow::Owned(out)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_outside_strings_only() {
        let given = br#"{"NaN \" NaN": [NaN, -Infinity, Infinity, 1]}"#;
        let expected = br#"{"NaN \" NaN": [null, null, null, 1]}"#;
        assert_eq!(without_non_finite(given).as_ref(), expected);
        assert!(matches!(without_non_finite(b"[1, \"\\"), Cow::Borrowed(_)));
    }
}
