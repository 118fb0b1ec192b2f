//! Answers as an `.npz` file.
//!
//! | query | arrays |
//! |---|---|
//! | closest | `t` float32 (inf on a miss), `primitive`, `geometry`, `instance` uint32 (4294967295 on a miss), `uv` float32 `(N, 2)`, `front_face` bool |
//! | any | `hit` bool |
//! | count | `count` uint32 |
//! | all | `offsets` uint64 of N + 1, and the arrays of `closest`: the hits of ray i are those from `offsets[i]` to `offsets[i + 1]`, sorted by `t` |

use super::npz::NpzWriter;
use ropewalk::{Answer, Hit};
use std::io::{self, Seek, Write};

/// Writes the answer of a batch.
pub(crate) fn write(writer: impl Write + Seek, answer: &Answer) -> io::Result<()> {
    let mut npz = NpzWriter::new(writer);
    match answer {
        Answer::Closest(hits) => write_hits(&mut npz, hits)?,
        Answer::Any(hits) => npz.array("hit", hits.iter().copied())?,
        Answer::Count(counts) => npz.array("count", counts.iter().copied())?,
        Answer::All(lists) => {
            npz.array("offsets", lists.offsets.iter().copied())?;
            write_hits(&mut npz, &lists.hits)?;
        }
    }
    npz.finish()
}

fn write_hits(npz: &mut NpzWriter<impl Write + Seek>, hits: &[Hit]) -> io::Result<()> {
    npz.array("t", hits.iter().map(|hit| hit.t))?;
    npz.array("primitive", hits.iter().map(|hit| hit.primitive_index))?;
    npz.array("geometry", hits.iter().map(|hit| hit.geometry_index))?;
    npz.array("instance", hits.iter().map(|hit| hit.instance_index))?;
    npz.rows("uv", hits.iter().map(|hit| hit.barycentrics.to_array()))?;
    npz.array("front_face", hits.iter().map(|hit| hit.front_face))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use npyz::NpyFile;
    use ropewalk::HitLists;
    use std::collections::BTreeMap;
    use std::io::{Cursor, Read};

    fn archive(answer: &Answer) -> BTreeMap<String, Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        write(&mut bytes, answer).unwrap();
        let mut archive = zip::ZipArchive::new(bytes).unwrap();
        (0..archive.len())
            .map(|index| {
                let mut file = archive.by_index(index).unwrap();
                let mut content = Vec::new();
                file.read_to_end(&mut content).unwrap();
                (file.name().unwrap().into_owned(), content)
            })
            .collect()
    }

    fn array<T: npyz::Deserialize>(archive: &BTreeMap<String, Vec<u8>>, name: &str) -> (Vec<u64>, Vec<T>) {
        let file = NpyFile::new(archive[name].as_slice()).unwrap();
        (file.shape().to_vec(), file.into_vec().unwrap())
    }

    #[test]
    fn another_reader_finds_the_hits() {
        let hit = Hit {
            t: 2.5,
            barycentrics: Vec2::new(0.25, 0.5),
            primitive_index: 7,
            geometry_index: 1,
            instance_index: 3,
            front_face: true,
        };
        let hits = archive(&Answer::Closest(vec![hit, Hit::MISS]));
        assert_eq!(array(&hits, "t.npy"), (vec![2], vec![2.5_f32, f32::INFINITY]));
        assert_eq!(array(&hits, "primitive.npy"), (vec![2], vec![7, u32::MAX]));
        assert_eq!(array(&hits, "geometry.npy"), (vec![2], vec![1, u32::MAX]));
        assert_eq!(array(&hits, "instance.npy"), (vec![2], vec![3, u32::MAX]));
        assert_eq!(array(&hits, "uv.npy"), (vec![2, 2], vec![0.25_f32, 0.5, 0.0, 0.0]));
        assert_eq!(array(&hits, "front_face.npy"), (vec![2], vec![true, false]));
        assert_eq!(hits.len(), 6);

        let lists = archive(&Answer::All(HitLists { offsets: vec![0, 0, 1], hits: vec![hit] }));
        assert_eq!(array(&lists, "offsets.npy"), (vec![3], vec![0_u64, 0, 1]));
        assert_eq!(array(&lists, "t.npy"), (vec![1], vec![2.5_f32]));
    }

    #[test]
    fn long_and_empty_arrays_are_whole() {
        let counts: Vec<u32> = (0..100_000).collect();
        assert_eq!(array(&archive(&Answer::Count(counts.clone())), "count.npy"), (vec![100_000], counts));
        assert_eq!(array(&archive(&Answer::Any(vec![])), "hit.npy"), (vec![0], Vec::<bool>::new()));
    }
}
