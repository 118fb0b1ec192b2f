//! MTL: what the surfaces of an OBJ file are made of.
//!
//! `Kd` and `Ke` are taken as linear, as ray tracers do. `Ns`, the exponent of a highlight, becomes the roughness whose
//! highlight is as wide: (2 / (Ns + 2))^¼; without a highlight (`Ks 0`, `illum 0` and `1`) a surface is matt. `d` and
//! `Tr` are opacity and its opposite; where both stand, `d` is right, for exporters disagree about `Tr`. `Pr` and `Pm`
//! of the later extension go before. `Ks` colours the mirror of the models that follow reflected rays, `illum` 3 to 9; `Ka` is
//! not read, since exporters write anything there. Of two materials of one name the first counts, as with libraries searched in order.

use super::document::Document;
use super::maps::Maps;
use crate::load::source::Source;
use crate::load::text::{Lines, number, words};
use crate::{LoadReport, Material};
use glam::Vec3;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;

/// More libraries than any scene has; a file may not make the program ask the file system without end.
const MOST_LIBRARIES: usize = 1000;

/// The materials of the files that a document names.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// In the order of the files.
    pub(super) list: Vec<Material>,
    /// Their pictures.
    pub(super) maps: Vec<Maps>,
    /// The first of each name.
    pub(super) by_name: HashMap<String, u32>,
    textures: usize,
}

/// Reads the libraries. One that is not there is noted, not an error: the geometry is there all the same.
pub(super) fn read_libraries(source: &Source, document: &mut Document) -> Materials {
    let mut materials = Materials::default();
    let mut names = Names { source, asked: 0, seen: HashSet::new() };
    let mut missing = Vec::new();
    for line in &document.libraries {
        for name in names.of(line) {
            match source.sibling(&name) {
                Ok(library) => materials.read(&library, &mut document.report),
                Err(error) => missing.push(error.to_string()),
            }
        }
    }
    if let Some(first) = missing.first() {
        let more =
            if missing.len() > 1 { format!(" (and {} more)", missing.len() - 1) } else { String::new() };
        document.report.notes.push(format!("materials not read: {first}{more}"));
    }
    if materials.textures > 0 {
        let note = "maps of materials are not read, such as those of highlights, bumps and displacement";
        document.report.notes.push(format!("{} {note}", materials.textures));
    }
    materials
}

/// Splits what stands behind `mtllib`: one name with blanks, or several names, in which `\ ` is a blank.
struct Names<'a> {
    source: &'a Source,
    asked: usize,
    seen: HashSet<String>,
}

impl Names<'_> {
    fn of(&mut self, line: &str) -> Vec<String> {
        // What no path can hold stands for a blank within a name.
        let words: Vec<String> =
            line.replace("\\ ", "\0").split_ascii_whitespace().map(|word| word.replace('\0', " ")).collect();
        let is_list = words.len() > 1
            && !self.is_there(line)
            // Where nothing is there a second ending tells a list from a name with blanks.
            && (words.iter().any(|word| self.is_there(word))
                || words.iter().filter(|word| word.to_ascii_lowercase().ends_with(".mtl")).count() > 1);
        let names = match words.as_slice() {
            [_] => words,
            _ if is_list => words,
            _ => vec![line.to_owned()],
        };
        names
            .into_iter()
            .filter(|name| self.seen.len() < MOST_LIBRARIES && self.seen.insert(name.clone()))
            .collect()
    }

    fn is_there(&mut self, name: &str) -> bool {
        self.asked += 1;
        let directory = self.source.path.parent().unwrap_or(Path::new(""));
        self.asked <= MOST_LIBRARIES
            && [name.to_owned(), format!("{name}.gz")].iter().any(|name| directory.join(name).is_file())
    }
}

impl Materials {
    fn read(&mut self, library: &Source, report: &mut LoadReport) {
        let path: Rc<Path> = library.path.as_path().into();
        let mut draft: Option<Draft> = None;
        let mut lines = Lines::new(&library.bytes);
        while let Some((line, text)) = lines.next_joined() {
            let text = text.trim_ascii();
            let mut words = words(text);
            let Some(keyword) = words.next() else { continue };
            let keyword = keyword.to_ascii_lowercase();
            if keyword == b"newmtl" {
                let name = text.get(keyword.len()..).unwrap_or_default().trim_ascii();
                let mut next = Draft::new(String::from_utf8_lossy(name).into_owned());
                next.maps.library = Some(Rc::clone(&path));
                self.add(draft.replace(next));
                continue;
            }
            let Some(draft) = &mut draft else { continue };
            let is_texture = [&b"map_"[..], b"bump", b"disp", b"decal", b"refl", b"norm"]
                .iter()
                .any(|start| keyword.starts_with(start));
            if is_texture {
                let is_read = draft.maps.set(&keyword, text.get(keyword.len()..).unwrap_or_default());
                self.textures += usize::from(!is_read && keyword != b"map_aat");
            } else if draft.set(&keyword, words).is_none() {
                let file = library.path.file_name().unwrap_or_default().to_string_lossy();
                report.skip("properties of materials that cannot be read", || format!("{file}, line {line}"));
            }
        }
        self.add(draft);
    }

    fn add(&mut self, draft: Option<Draft>) {
        let Some(draft) = draft else { return };
        if !self.by_name.contains_key(&draft.material.name) {
            self.by_name.insert(draft.material.name.clone(), self.list.len() as u32);
            let (material, maps) = draft.finish();
            self.list.push(material);
            self.maps.push(maps);
        }
    }
}

/// A material while its lines come in.
struct Draft {
    material: Material,
    maps: Maps,
    exponent: f32,
    highlight: Vec3,
    has_highlight: bool,
    illumination: Option<f64>,
    roughness: Option<f32>,
    opacity: Option<f32>,
    transparency: Option<f32>,
    filter: Option<Vec3>,
}

impl Draft {
    fn new(name: String) -> Self {
        Self {
            material: Material { name, ..Material::default() },
            maps: Maps::default(),
            exponent: 0.0,
            highlight: Vec3::ONE,
            has_highlight: false,
            illumination: None,
            roughness: None,
            opacity: None,
            transparency: None,
            filter: None,
        }
    }

    /// None where the values cannot be read. Unknown words are fine: there are many dialects.
    fn set<'a>(&mut self, keyword: &[u8], mut words: impl Iterator<Item = &'a [u8]>) -> Option<()> {
        match keyword {
            b"kd" => {
                self.material.base_color = color(words)?;
                self.maps.has_color = true;
            }
            b"ke" => {
                self.material.emissive = color(words)?;
                self.maps.has_emission = true;
            }
            b"ks" => {
                self.highlight = color(words)?;
                self.has_highlight = true;
            }
            b"tf" => self.filter = Some(color(words)?),
            b"ns" => self.exponent = amount(words.next())?,
            b"ni" => self.material.ior = amount(words.next())?,
            b"pr" => self.roughness = Some(amount(words.next())?.min(1.0)),
            b"pm" => self.material.metallic = amount(words.next())?.min(1.0),
            b"tr" => self.transparency = Some(amount(words.next())?.min(1.0)),
            b"d" => self.opacity = Some(amount(words.find(|&word| word != b"-halo"))?.min(1.0)),
            b"illum" => self.illumination = Some(number(words.next()?)?),
            _ => {}
        }
        Some(())
    }

    fn finish(self) -> (Material, Maps) {
        let has_highlight =
            self.highlight != Vec3::ZERO && self.illumination.is_none_or(|model| model >= 2.0);
        let from_exponent = if has_highlight { (2.0 / (self.exponent + 2.0)).powf(0.25) } else { 1.0 };
        let transparency = self.opacity.map(|opacity| 1.0 - opacity).or(self.transparency).unwrap_or(0.0);
        // Glass that is opaque by `d`: models 4 to 7 and 9 let light through the filter `Tf`.
        let is_glass = self.illumination.is_some_and(|model| (4.0..=7.0).contains(&model) || model == 9.0);
        let through_glass =
            self.filter.filter(|_| is_glass && transparency == 0.0).map(|filter| filter.element_sum() / 3.0);
        let mirrors = self.has_highlight
            && self.highlight != Vec3::ZERO
            && self.illumination.is_some_and(|model| (3.0..=9.0).contains(&model));
        let material = Material {
            roughness: self.roughness.unwrap_or(from_exponent),
            specular: mirrors.then(|| self.highlight.min(Vec3::ONE)),
            mirrors_sharply: mirrors,
            transmission: through_glass.unwrap_or(transparency).min(1.0),
            ..self.material
        };
        (material, self.maps)
    }
}

/// Three amounts, or one for all; tables of wavelengths and CIE colours are not read.
fn color<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<Vec3> {
    let red = amount(words.next())?;
    let Some(green) = words.next().filter(|word| !word.starts_with(b"#")) else {
        return Some(Vec3::splat(red));
    };
    Some(Vec3::new(red, amount(Some(green))?, amount(words.next())?))
}

/// A finite number that is not negative.
fn amount(word: Option<&[u8]>) -> Option<f32> {
    let value = number(word?)? as f32;
    (value.is_finite() && value >= 0.0).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Materials, LoadReport) {
        let source = Source { path: "x.mtl".into(), bytes: text.into() };
        let (mut materials, mut report) = (Materials::default(), LoadReport::default());
        materials.read(&source, &mut report);
        (materials, report)
    }

    #[test]
    fn properties_are_read() {
        let (materials, report) = read(
            "Kd 9 9 9\nnewmtl red glass\n  Kd 1 .5 0\nKe 2 # bright\nNs 30\nd 0.25\nTr 0.1\nNi 1.3\nillum 2\n\
             newmtl matt\nKs 0 0 0\nNs 1000\nnewmtl metal\nPr .25\nPm 1\nmap_Kd x.png\nmap_bump y.png\n\
             newmtl pane\nillum 7\nTf 1 1 1\nd 1\nnewmtl matt\nKd 0 0 0\n",
        );
        let names: Vec<_> = materials.list.iter().map(|material| material.name.as_str()).collect();
        assert_eq!(names, ["red glass", "matt", "metal", "pane"]);
        let glass = &materials.list[0];
        assert_eq!((glass.base_color, glass.emissive), (Vec3::new(1.0, 0.5, 0.0), Vec3::splat(2.0)));
        assert_eq!((glass.roughness, glass.transmission, glass.ior), (0.5, 0.75, 1.3));
        let matt = &materials.list[1];
        assert_eq!(
            (matt.roughness, matt.base_color),
            (1.0, Material::default().base_color),
            "the first counts"
        );
        assert_eq!((materials.list[2].roughness, materials.list[2].metallic), (0.25, 1.0));
        assert_eq!(materials.list[3].transmission, 1.0);
        assert_eq!(materials.textures, 1, "the bump");
        assert_eq!(report, LoadReport::default());
    }

    #[test]
    fn what_cannot_be_read_is_counted() {
        let (materials, report) =
            read("newmtl a\nKd x 1 1\nKd -1 0 0\nNs nan\nKd spectral a.rfl\nd\nwhatever 1\n");
        assert_eq!(materials.list[0], Material { name: "a".into(), ..Material::default() });
        assert_eq!((report.skipped_count(), report.skipped[0].first.as_str()), (5, "x.mtl, line 2"));
    }
}
