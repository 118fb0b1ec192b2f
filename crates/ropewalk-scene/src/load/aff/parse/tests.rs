use super::*;

fn source(text: &str) -> Source {
    Source { path: "x.aff".into(), bytes: text.into() }
}

#[test]
fn everything_that_unfolds_takes_from_the_budget() {
    let key = "0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 ".repeat(2);
    for statement in [
        "s 0 0 0 1",
        "c 0 0 0 1 0 1 0 1",
        "p 3 0 0 0 1 0 0 0 1 0",
        "l 0 0 0",
        "x a { }",
        &format!("tpa 2 {key}"),
    ] {
        let text = format!("d 1\n{statement}");
        let mut parser = Parser::new();
        assert!(parser.file(&source(&text)).is_ok(), "{statement}");
        let mut parser = Parser::new();
        // All that there is without a file.
        parser.budget.take(512 << 20).unwrap();
        let error = parser.file(&source(&text)).unwrap_err().to_string();
        assert!(error.contains("x.aff: line 2: the scene takes more than"), "{statement}: {error}");
    }
}

#[test]
fn the_last_of_equal_names_counts() {
    let track = |x: u32| format!("k a {{ transl 4 {} }}", format!("0 {x} 0 0 0 0 0 ").repeat(4));
    let document = parse(&source(&format!("{}{}x a {{ }}", track(1), track(2)))).unwrap();
    assert_eq!(document.standings(0.0)[0].to_world.translation.x, 2.0);
}

#[test]
fn names_tell_the_two_formats_apart() {
    for (name, expected) in [("a.NFF", "NFF"), ("a.nff.gz", "NFF"), ("a.aff", "AFF"), ("nff", "AFF")] {
        assert_eq!(format(&Source { path: name.into(), bytes: Vec::new() }), expected);
    }
}
