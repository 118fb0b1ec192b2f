//! Writing `.npz` files: zip archives of `.npy` arrays, stored and not compressed, as numpy's `savez` makes them.

use super::header::Header;
use std::io::{self, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Elements that are turned into bytes at a time.
const PIECE: usize = 1 << 15;

/// A number that an array can hold.
pub(crate) trait Element {
    /// numpy's name of the type.
    const DESCR: &'static str;
    /// Bytes an element.
    const SIZE: usize;
    /// Appends the element.
    fn write(self, bytes: &mut Vec<u8>);
}

macro_rules! element {
    ($number:ty, $descr:literal) => {
        impl Element for $number {
            const DESCR: &'static str = $descr;
            const SIZE: usize = size_of::<Self>();
            fn write(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    };
}

element!(f32, "<f4");
element!(f64, "<f8");
element!(u32, "<u4");
element!(u64, "<u8");

impl Element for bool {
    const DESCR: &'static str = "|b1";
    const SIZE: usize = 1;
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self));
    }
}

/// An archive that is being written.
pub(crate) struct NpzWriter<W: Write + Seek>(ZipWriter<W>);

impl<W: Write + Seek> NpzWriter<W> {
    pub(crate) fn new(writer: W) -> Self {
        Self(ZipWriter::new(writer))
    }

    /// Adds an array of one dimension.
    pub(crate) fn array<T: Element>(
        &mut self,
        name: &str,
        values: impl ExactSizeIterator<Item = T>,
    ) -> io::Result<()> {
        let shape = vec![values.len() as u64];
        self.write(name, shape, values)
    }

    /// Adds an array of rows of `WIDTH` elements.
    pub(crate) fn rows<T: Element, const WIDTH: usize>(
        &mut self,
        name: &str,
        values: impl ExactSizeIterator<Item = [T; WIDTH]>,
    ) -> io::Result<()> {
        let shape = vec![values.len() as u64, WIDTH as u64];
        self.write(name, shape, values.flatten())
    }

    fn write<T: Element>(
        &mut self,
        name: &str,
        shape: Vec<u64>,
        mut values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        let count: u64 = shape.iter().product();
        let header = Header { descr: T::DESCR.into(), fortran_order: false, shape }.to_bytes();
        let size = header.len() as u64 + count * T::SIZE as u64;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(size >= u64::from(u32::MAX));
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0.write_all(&header)?;
        let mut bytes = Vec::with_capacity(PIECE * T::SIZE);
        loop {
            bytes.clear();
            for value in values.by_ref().take(PIECE) {
                value.write(&mut bytes);
            }
            if bytes.is_empty() {
                return Ok(());
            }
            self.0.write_all(&bytes)?;
        }
    }

    /// Writes the archive's directory.
    pub(crate) fn finish(self) -> io::Result<()> {
        self.0.finish()?;
        Ok(())
    }
}
