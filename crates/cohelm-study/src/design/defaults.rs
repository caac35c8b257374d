//! Texts that are read where a file gives none, in the languages the page speaks.

use super::{InstructionPage, Instructions, Picture, Words};

/// Whether a text is one of these, which may be given in more languages than a study has.
pub(super) fn is_one(words: &Words) -> bool {
    let pages = Instructions::default().pages;
    let read = |page: &InstructionPage| page.title == *words || page.text == *words;
    [debrief(), pause(), block_text()].contains(words) || pages.iter().any(read)
}

/// The same text in English and German.
pub(crate) fn both(english: &str, german: &str) -> Words {
    Words::By([("en", english), ("de", german)].map(|(code, text)| (code.to_owned(), text.to_owned())).into())
}

/// After the last questionnaire.
pub(super) fn debrief() -> Words {
    both(
        "That was the last part. Your flights and answers are stored. If you have questions about the study, or want \
         your data deleted, write to the address below.",
        "Das war der letzte Teil. Ihre Flüge und Antworten sind gespeichert. Wenn Sie Fragen zur Studie haben oder Ihre \
         Daten löschen lassen möchten, schreiben Sie an die unten genannte Adresse.",
    )
}

/// During a break.
pub(super) fn pause() -> Words {
    both(
        "Time for a short break. Look away from the screen for a moment, and go on when you are ready.",
        "Zeit für eine kurze Pause. Schauen Sie einen Moment vom Bildschirm weg und machen Sie weiter, wenn Sie bereit sind.",
    )
}

/// At the very end.
pub(crate) fn thanks() -> Words {
    both("Thank you for taking part.", "Vielen Dank für Ihre Teilnahme.")
}

/// On the button that leads back to a panel.
pub(crate) fn panel_button() -> Words {
    both("Back to the panel", "Zurück zum Panel")
}

/// The label of the mode that is flown as the n-th, from 0: it tells nothing about the mode.
pub(crate) fn mode_label(place: usize) -> Words {
    let letter = letters(place);
    both(&format!("Mode {letter}"), &format!("Modus {letter}"))
}

/// A to Z, then AA, AB, …
fn letters(place: usize) -> String {
    let last = char::from(b'A' + (place % 26) as u8);
    if place < 26 { last.to_string() } else { letters(place / 26 - 1) + &last.to_string() }
}

/// Before a block's flights.
pub(super) fn block_text() -> Words {
    both(
        "The controls answer a little differently in each mode. Steer to your goal as well as you can.",
        "In jedem Modus reagiert die Steuerung etwas anders. Steuern Sie so gut Sie können zu Ihrem Ziel.",
    )
}

impl Default for Instructions {
    fn default() -> Self {
        Self {
            pages: vec![
                InstructionPage {
                    title: both("Your task", "Ihre Aufgabe"),
                    text: both(
                        "Steer to your goal and come to rest there, gently. The picture shows which goal is yours. A \
                         flight ends when you have arrived, after a crash, outside the picture, or when the time is up.",
                        "Steuern Sie zu Ihrem Ziel und kommen Sie dort sanft zur Ruhe. Das Bild zeigt, welches Ziel Ihres \
                         ist. Ein Flug endet, wenn Sie angekommen sind, nach einem Absturz, außerhalb des Bildes, oder \
                         wenn die Zeit um ist.",
                    ),
                    picture: Some(Picture::Task),
                },
                InstructionPage {
                    title: both("The keys", "Die Tasten"),
                    text: both(
                        "These are the keys. You can set other keys if you like, or use a gamepad. You will \
                         fly in several modes; in some of them a computer helps.",
                        "Mit diesen Tasten steuern Sie. Sie können andere Tasten einstellen oder ein Gamepad benutzen. \
                         Sie fliegen in mehreren Modi; in manchen hilft ein Computer mit.",
                    ),
                    picture: Some(Picture::Controls),
                },
            ],
        }
    }
}
