//! The text of a document that a client edits: what the language server holds of it, and places in it.

use crate::document::{Encoding, Place, Text};
use crate::script::{ENCODINGS, byte, run};
use proptest::prelude::*;

fn some_text() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        "[a-z ]{0,4}".prop_map(String::from),
        proptest::sample::select(vec!["\n", "\r\n", "\r", "é", "😀", "\u{2028}"]).prop_map(String::from),
    ];
    proptest::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

fn some_place() -> impl Strategy<Value = Place> {
    (0u32..12, 0u32..14).prop_map(|(line, character)| Place { line, character })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn places_are_what_the_protocol_says(text in some_text(), place in some_place()) {
        let document = Text::new(text.clone());
        for encoding in ENCODINGS {
            let at = document.byte(place, encoding);
            prop_assert_eq!(at, byte(&text, place, encoding));
            prop_assert_eq!(document.byte(document.place(at, encoding), encoding), at);
        }
    }

    #[test]
    fn after_any_edits_the_text_is_the_clients(script in proptest::collection::vec(any::<u8>(), 0..120)) {
        run(&script);
    }
}

#[test]
fn a_place_within_a_character_is_the_one_before() {
    let text = Text::new("a😀b\r\nc".into());
    let byte = |character, encoding| text.byte(Place { line: 0, character }, encoding);
    assert_eq!([0, 1, 2, 3, 4, 9].map(|n| byte(n, Encoding::Utf16)), [0, 1, 1, 5, 6, 6]);
    assert_eq!([0, 1, 2, 4, 5, 9].map(|n| byte(n, Encoding::Utf8)), [0, 1, 1, 1, 5, 6]);
    assert_eq!([0, 1, 2, 3, 9].map(|n| byte(n, Encoding::Utf32)), [0, 1, 5, 6, 6]);
    for (encoding, torn) in [(Encoding::Utf8, 2..5), (Encoding::Utf16, 2..3), (Encoding::Utf32, 0..0)] {
        for character in 0..12 {
            let place = Place { line: 0, character };
            assert_eq!(text.is_torn(place, encoding), torn.contains(&character), "{place:?} {encoding:?}");
        }
    }
    assert!(!text.is_torn(Place { line: 2, character: 7 }, Encoding::Utf16));
    assert_eq!(text.place(7, Encoding::Utf16), Place { line: 0, character: 4 });
    assert_eq!(text.whole().len(), text.byte(Place { line: 7, character: 0 }, Encoding::Utf8));
}
