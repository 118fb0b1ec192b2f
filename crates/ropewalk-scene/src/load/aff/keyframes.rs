//! The statement `k`: the tracks of a name.

use super::animation::Keyframes;
use super::tokens::Tokens;
use super::track::{FEWEST_KEYS, Key, RotationTrack, VectorTrack, VisibilityTrack};
use crate::LoadError;
use crate::load::text::quoted;
use glam::DVec3;

/// Reads what stands behind the name: `{`, tracks, `}`.
pub(super) fn read(tokens: &mut Tokens<'_>) -> Result<Keyframes, LoadError> {
    tokens.expect("{")?;
    let mut found = Keyframes::default();
    loop {
        let kind = tokens.word("a track, or '}' behind the last,")?;
        let is_second = match kind {
            b"}" => return Ok(found),
            b"transl" => found.translation.replace(vectors(tokens)?).is_some(),
            b"scale" => found.scale.replace(vectors(tokens)?).is_some(),
            b"rot" => found.rotation.replace(rotations(tokens)?).is_some(),
            b"visibility" => found.visibility.replace(visibility(tokens)?).is_some(),
            _ => {
                let what = format!(
                    "{} is no track; there are 'transl', 'rot', 'scale' and 'visibility'",
                    quoted(kind)
                );
                return Err(tokens.malformed(what));
            }
        };
        if is_second {
            return Err(tokens.malformed(format!("this is the end of a second track {}", quoted(kind))));
        }
    }
}

fn vectors(tokens: &mut Tokens<'_>) -> Result<VectorTrack, LoadError> {
    let keys = keys(tokens, 7, Tokens::vector)?;
    VectorTrack::new(keys).ok_or_else(|| too_few(tokens))
}

fn rotations(tokens: &mut Tokens<'_>) -> Result<RotationTrack, LoadError> {
    let keys: Vec<Key<(DVec3, f64)>> = keys(tokens, 8, |tokens| Ok((tokens.vector()?, tokens.number()?)))?;
    RotationTrack::new(&keys).ok_or_else(|| too_few(tokens))
}

fn keys<'a, V>(
    tokens: &mut Tokens<'a>,
    width: usize,
    mut value: impl FnMut(&mut Tokens<'a>) -> Result<V, LoadError>,
) -> Result<Vec<Key<V>>, LoadError> {
    let count = tokens.count(width, "keys")?;
    if count < FEWEST_KEYS {
        return Err(too_few(tokens));
    }
    let mut keys = Vec::with_capacity(count);
    for _ in 0..count {
        let (time, value) = (tokens.number()?, value(tokens)?);
        let (tension, continuity, bias) = (tokens.number()?, tokens.number()?, tokens.number()?);
        keys.push(Key { time, value, tension, continuity, bias });
    }
    Ok(keys)
}

fn too_few(tokens: &Tokens<'_>) -> LoadError {
    tokens.malformed(format!(
        "a track takes at least {FEWEST_KEYS} keys: the first and the last are never reached"
    ))
}

fn visibility(tokens: &mut Tokens<'_>) -> Result<VisibilityTrack, LoadError> {
    let count = tokens.count(2, "keys")?;
    if count == 0 {
        return Err(tokens.malformed("a visibility track without keys; it must have at least one"));
    }
    let mut keys = Vec::with_capacity(count);
    for _ in 0..count {
        keys.push((tokens.number()?, tokens.number()? != 0.0));
    }
    Ok(VisibilityTrack(keys))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::source::Source;

    fn of(text: &str) -> Result<Keyframes, String> {
        let source = Source { path: "x.aff".into(), bytes: text.into() };
        read(&mut Tokens::new(&source)).map_err(|error| error.to_string())
    }

    #[test]
    fn tracks_come_in_any_order() {
        let keys = "4 0 1 2 3 0 0 0  1 1 2 3 0 0 0  2 1 2 3 0 0 0  3 1 2 3 0 0 0";
        let text = format!("{{ visibility 1 0 0 scale {keys} transl {keys} }}");
        let found = of(&text).unwrap();
        assert_eq!(found.tracks(), 3);
        assert!(!found.is_visible(0.0) && found.is_visible(-1.0) && found.rotation(0.0).is_none());
        assert_eq!(found.transform(1.5).translation, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(
            found.transform(1.5).matrix3.to_cols_array(),
            [1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0]
        );
        assert_eq!(of("{}"), Ok(Keyframes::default()));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let three = "transl 3 0 0 0 0 0 0 0 1 0 0 0 0 0 0 2 0 0 0 0 0 0";
        for (text, words) in [
            ("", "'{' must stand"),
            ("{", "a track, or '}'"),
            ("{ turn 1", "'turn' is no track"),
            (&format!("{{ {three} }}"), "at least 4 keys"),
            ("{ rot 9000 0 0", "9000 keys are promised, but only"),
            ("{ visibility 0 }", "at least one"),
            ("{ visibility 1 0 1 visibility 1 0 1 }", "second track 'visibility'"),
            ("{\nvisibility 1 0 x }", "line 2: 'x' stands where a number"),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
