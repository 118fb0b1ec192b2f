//! Rows of numbers from an `.npy` file: float32 or float64 of either byte order, in C or in Fortran order.
//!
//! What a row means, a ray or a point, is told by [`FileRow`]. The scene's own origin is taken off in f64, before a
//! position is rounded to f32: what lies near a scene that is far from zero keeps its accuracy. A file in C order is
//! converted piece by piece while it is read, so that it is never in memory as a whole.

use super::header::{Header, read_exact};
use crate::failure::Failure;
use glam::DVec3;
use rayon::prelude::*;
use std::fs::File;
use std::io::{BufReader, Read};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

/// Rows that are read and converted at a time: a few MiB.
pub(super) const PIECE: usize = 1 << 16;

/// What stands in a row.
pub(crate) trait FileRow: Sized + Send + Sync {
    /// What many of them are called.
    const THINGS: &'static str;
    /// How many numbers a row may have.
    const COLUMNS: &'static [usize];
    /// What cannot be done with a row that has a defect, and the way out.
    const REFUSAL: Refusal;

    /// Makes sense of a row, in the space of a scene whose zero lies at `origin`.
    fn read(row: &Row<'_>, origin: DVec3) -> Self;

    /// Why there is no answer to it; `None` where there is one.
    fn defect(&self) -> Option<&'static str>;
}

/// How a file with defective rows is refused.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refusal {
    /// Such as "cannot be traced".
    pub(crate) cannot: &'static str,
    /// What keeps such rows.
    pub(crate) way_out: &'static str,
}

/// What is done with rows that have a defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InvalidRows {
    /// The file is refused.
    Refuse,
    /// They are kept, and answered as if nothing was there.
    Keep,
}

impl InvalidRows {
    /// What `--allow-invalid-...` says.
    pub(crate) const fn allowed(allow: bool) -> Self {
        if allow { Self::Keep } else { Self::Refuse }
    }
}

/// A file whose header was read and makes sense.
#[derive(Debug)]
pub(crate) struct RowsFile<T, R = BufReader<File>> {
    path: PathBuf,
    reader: R,
    layout: Layout,
    kind: PhantomData<fn() -> T>,
}

/// What a file held.
#[derive(Debug)]
pub(crate) struct Rows<T> {
    /// The rows, in the space of the scene.
    pub(crate) rows: Vec<T>,
    /// How many of them have a defect.
    pub(crate) invalid: usize,
    /// Bytes after the last row, which were not looked at.
    pub(crate) unread: u64,
}

impl<T: FileRow> RowsFile<T> {
    /// Opens a file and checks what it claims to hold.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let failure = |what: &dyn std::fmt::Display| Failure::failed(format!("{}: {what}", path.display()));
        let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => failure(&"there is no such file"),
            _ => failure(&error),
        })?;
        if !metadata.is_file() {
            let what = format!("this is no regular file; {} are read from an .npy file", T::THINGS);
            return Err(failure(&what));
        }
        let file = File::open(path).map_err(|error| failure(&error))?;
        Self::new(path, BufReader::with_capacity(1 << 16, file), metadata.len())
            .map_err(|what| failure(&what))
    }
}

impl<T: FileRow, R: Read> RowsFile<T, R> {
    pub(super) fn new(path: &Path, mut reader: R, file_length: u64) -> Result<Self, String> {
        let header = Header::read(&mut reader)?;
        let layout = Layout::of::<T>(&header, file_length)?;
        Ok(Self { path: path.into(), reader, layout, kind: PhantomData })
    }

    /// How many numbers a row has.
    pub(crate) const fn columns(&self) -> usize {
        self.layout.columns
    }

    /// Reads the rows for a scene whose zero lies at `origin`.
    pub(crate) fn read(mut self, origin: DVec3, invalid_rows: InvalidRows) -> Result<Rows<T>, Failure> {
        let failure = |what: String| Failure::failed(format!("{}: {what}", self.path.display()));
        let rows: Vec<T> = self.layout.read(&mut self.reader, origin).map_err(failure)?;
        let invalid = rows.par_iter().filter(|row| row.defect().is_some()).count();
        if invalid > 0 && invalid_rows == InvalidRows::Refuse {
            let (row, reason) = first_invalid(&rows).unwrap_or((0, "it is not valid"));
            let (count, things, Refusal { cannot, way_out }) = (rows.len(), T::THINGS, T::REFUSAL);
            return Err(failure(format!(
                "{invalid} of {count} {things} {cannot}; the first is row {row}: {reason} ({way_out})"
            )));
        }
        let unread = std::io::copy(&mut self.reader, &mut std::io::sink()).unwrap_or(0);
        Ok(Rows { rows, invalid, unread })
    }
}

/// The first row that has a defect, and which.
pub(super) fn first_invalid<T: FileRow>(rows: &[T]) -> Option<(usize, &'static str)> {
    rows.iter().enumerate().find_map(|(index, row)| row.defect().map(|reason| (index, reason)))
}

/// A row as it stands in the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    number: Number,
    bytes: &'a [u8],
    /// The place of the first number, in numbers, and how far it is to the next one.
    first: usize,
    step: usize,
    columns: usize,
}

impl Row<'_> {
    /// How many numbers it has.
    pub(crate) const fn columns(&self) -> usize {
        self.columns
    }

    /// The number in a column; NaN where there is none.
    pub(crate) fn value(&self, column: usize) -> f64 {
        self.number.read(self.bytes, self.first + column * self.step)
    }

    /// The three numbers from a column on.
    pub(crate) fn vector(&self, column: usize) -> DVec3 {
        DVec3::new(self.value(column), self.value(column + 1), self.value(column + 2))
    }
}

/// How the rows stand in the file.
#[derive(Clone, Copy, Debug)]
struct Layout {
    number: Number,
    rows: usize,
    columns: usize,
    /// Column after column instead of row after row.
    fortran_order: bool,
}

impl Layout {
    fn of<T: FileRow>(header: &Header, file_length: u64) -> Result<Self, String> {
        let number = Number::of(&header.descr)?;
        let (rows, columns) = match header.shape[..] {
            [rows, given] => {
                T::COLUMNS.iter().find(|&&columns| columns as u64 == given).map(|&it| (rows, it))
            }
            _ => None,
        }
        .ok_or_else(|| wrong_shape::<T>(&header.shape))?;
        // What the file claims is believed only when it is that long.
        let bytes = rows.checked_mul((columns * number.size) as u64);
        match (bytes, usize::try_from(rows)) {
            (Some(bytes), Ok(rows)) if bytes <= file_length => {
                Ok(Self { number, rows, columns, fortran_order: header.fortran_order })
            }
            _ => Err(format!("it is cut off: it is too short for its {rows} rows")),
        }
    }

    fn read<T: FileRow>(self, reader: &mut impl Read, origin: DVec3) -> Result<Vec<T>, String> {
        let Self { number, rows, columns, fortran_order } = self;
        let row_bytes = columns * number.size;
        let cut = format!("it is cut off: it ends before the last of its {rows} rows");
        let mut read = Vec::new();
        read.try_reserve_exact(rows).map_err(|_| format!("there is no memory for {rows} {}", T::THINGS))?;
        if fortran_order {
            let mut bytes = vec![0; rows * row_bytes];
            read_exact(reader, &mut bytes, &cut)?;
            let row = |first: usize| Row { number, bytes: &bytes, first, step: rows, columns };
            (0..rows).into_par_iter().map(|first| T::read(&row(first), origin)).collect_into_vec(&mut read);
        } else {
            let mut bytes = vec![0; PIECE.min(rows) * row_bytes];
            for first in (0..rows).step_by(PIECE) {
                let piece = &mut bytes[..PIECE.min(rows - first) * row_bytes];
                read_exact(reader, piece, &cut)?;
                let row = |bytes| Row { number, bytes, first: 0, step: 1, columns };
                read.par_extend(piece.par_chunks_exact(row_bytes).map(|bytes| T::read(&row(bytes), origin)));
            }
        }
        Ok(read)
    }
}

fn wrong_shape<T: FileRow>(shape: &[u64]) -> String {
    let lengths: Vec<String> = shape.iter().map(u64::to_string).collect();
    let right: Vec<String> = T::COLUMNS.iter().map(|columns| format!("(N, {columns})")).collect();
    format!("its shape is ({}); {} have the shape {}", lengths.join(", "), T::THINGS, right.join(" or "))
}

/// How a number stands in the file.
#[derive(Clone, Copy, Debug)]
struct Number {
    size: usize,
    big_endian: bool,
}

impl Number {
    fn of(descr: &str) -> Result<Self, String> {
        let (order, kind) = descr.split_at_checked(1).unwrap_or(("", descr));
        let big_endian = match order {
            "<" => false,
            ">" => true,
            "=" | "|" => cfg!(target_endian = "big"),
            _ => return Err(wrong_type(descr)),
        };
        match kind {
            "f4" => Ok(Self { size: 4, big_endian }),
            "f8" => Ok(Self { size: 8, big_endian }),
            _ => Err(wrong_type(descr)),
        }
    }

    /// The number at `index`; NaN where the bytes end.
    fn read(self, bytes: &[u8], index: usize) -> f64 {
        let bytes = bytes.get(index * self.size..(index + 1) * self.size).unwrap_or(&[]);
        match (<[u8; 4]>::try_from(bytes), <[u8; 8]>::try_from(bytes)) {
            (Ok(bytes), _) if self.big_endian => f32::from_be_bytes(bytes).into(),
            (Ok(bytes), _) => f32::from_le_bytes(bytes).into(),
            (_, Ok(bytes)) if self.big_endian => f64::from_be_bytes(bytes),
            (_, Ok(bytes)) => f64::from_le_bytes(bytes),
            _ => f64::NAN,
        }
    }
}

fn wrong_type(descr: &str) -> String {
    format!("its numbers are of type '{descr}'; float32 and float64 can be read")
}
