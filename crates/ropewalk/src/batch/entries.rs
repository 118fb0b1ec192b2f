//! The two functions by which every structure traces a batch by any walk of the catalogue.

/// Gives a structure `trace` and `trace_filtered`: the catalogue is asked first, then the structure's own `trace_batch`.
macro_rules! trace_entries {
    ($structure:ident, $kind:ident) => {
        impl $structure {
            /// Traces a batch by any walk of the catalogue.
            ///
            /// # Errors
            /// When the walk does not answer the query, or the structure is too deep for it.
            pub fn trace(
                &self,
                walk: $crate::Walk,
                query: $crate::Query,
                rays: &[$crate::Ray],
                options: $crate::TraceOptions,
            ) -> Result<$crate::Traced, $crate::TraceError> {
                self.trace_checked(walk, $crate::batch::Batch { query, rays, options, keep: None })
            }

            /// Traces a batch by any walk of the catalogue, as if the hits that `keep` does not keep were not there.
            ///
            /// # Errors
            /// As [`Self::trace`].
            pub fn trace_filtered(
                &self,
                walk: $crate::Walk,
                query: $crate::Query,
                rays: &[$crate::Ray],
                options: $crate::TraceOptions,
                keep: $crate::Keep<'_>,
            ) -> Result<$crate::Traced, $crate::TraceError> {
                self.trace_checked(walk, $crate::batch::Batch { query, rays, options, keep: Some(keep) })
            }

            fn trace_checked(
                &self,
                walk: $crate::Walk,
                batch: $crate::batch::Batch<'_>,
            ) -> Result<$crate::Traced, $crate::TraceError> {
                let (kind, device) = ($crate::StructureKind::$kind, $crate::DeviceKind::Cpu);
                $crate::catalogue::check(kind, walk, batch.query, device)?;
                self.trace_batch(walk, batch)
            }
        }
    };
}
pub(crate) use trace_entries;
