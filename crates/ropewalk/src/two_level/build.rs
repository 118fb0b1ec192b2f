//! From a scene to both levels.

use super::change::Pending;
use super::{ObjectStructure, Placed, TopLevel, TwoLevel, TwoLevelOptions};
use crate::clock::Clock;
use crate::{
    BuildError, BuildReport, FlatTriangle, InputReport, Instance, Monitor, NoMonitor, Scene, SceneError,
};
use std::sync::Arc;

impl Scene {
    /// Builds a structure for each object, and a top level over all instances.
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build_two_level(&self, options: &TwoLevelOptions) -> Result<TwoLevel, BuildError> {
        self.build_two_level_monitored(options, &NoMonitor)
    }

    /// Builds a structure for each object, and a top level over all instances, under the eyes of a monitor that may
    /// cancel it. The monitor hears of one object after the other.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_two_level_monitored(
        &self,
        options: &TwoLevelOptions,
        monitor: &dyn Monitor,
    ) -> Result<TwoLevel, BuildError> {
        let clock = Clock::start();
        options.check()?;
        self.check_instances()?;
        let mut objects = Vec::with_capacity(self.objects.len());
        for (index, object) in self.objects.iter().enumerate() {
            let bottom = options.bottoms.of(index);
            let structure = ObjectStructure::build(object, bottom, options.oriented, monitor)?;
            objects.push(Some(Arc::new(structure)));
        }
        let instances = self.instances.iter().copied().map(Some).collect();
        let mut two_level = TwoLevel::assemble(*options, objects, instances)?;
        two_level.report.build_time = clock.elapsed();
        Ok(two_level)
    }
}

impl TwoLevel {
    /// Puts objects that have their structures already under a new top level; several scenes may share them. What is `None`
    /// keeps its index and is not there.
    ///
    /// # Errors
    /// When an instance names no object or cannot be placed, or there are too many.
    pub fn assemble(
        options: TwoLevelOptions,
        objects: Vec<Option<Arc<ObjectStructure>>>,
        instances: Vec<Option<Instance>>,
    ) -> Result<Self, BuildError> {
        options.check()?;
        let limit = FlatTriangle::INSTANCE_LIMIT;
        if instances.len() > limit {
            return Err(SceneError::TooManyInstances { instances: instances.len(), limit }.into());
        }
        for (index, instance) in instances.iter().enumerate() {
            let object = instance.map(|instance| instance.object);
            if let Some(object) =
                object.filter(|&object| !matches!(objects.get(object as usize), Some(Some(_))))
            {
                let objects = objects.len();
                return Err(SceneError::NoSuchObject { instance: index, object, objects }.into());
            }
        }
        let mut two_level = Self {
            options,
            objects,
            instances,
            placed: Vec::new(),
            places: Vec::new(),
            entries: Vec::new(),
            boxes: Vec::new(),
            top: TopLevel::default(),
            width: 0.0,
            report: BuildReport::default(),
            pending: Pending::default(),
        };
        two_level.place_all()?;
        two_level.rebuild_top()?;
        two_level.measure();
        Ok(two_level)
    }

    /// Places every instance of an object that has triangles.
    pub(super) fn place_all(&mut self) -> Result<(), SceneError> {
        self.placed.clear();
        self.places.clear();
        self.places.resize(self.instances.len(), Self::NOWHERE);
        for (index, instance) in self.instances.iter().enumerate() {
            let Some(instance) = instance else { continue };
            let Some(object) = self.objects.get(instance.object as usize).and_then(Option::as_ref) else {
                continue;
            };
            if !object.is_empty() {
                self.places[index] = self.placed.len() as u32;
                self.placed.push(placed(index, instance, object)?);
            }
        }
        Ok(())
    }

    /// Builds the top level anew over what is placed.
    pub(super) fn rebuild_top(&mut self) -> Result<(), SceneError> {
        self.open();
        self.top.rebuild(&self.boxes)?;
        Ok(())
    }

    /// Moves the boxes of the top level, and with `restructure` builds anew what that made bad.
    pub(super) fn refit_top(&mut self, restructure: bool) -> Result<(), SceneError> {
        self.follow();
        self.top.refit(&self.boxes)?;
        if restructure {
            self.top.restructure(TopLevel::TOLERANCE);
        }
        Ok(())
    }

    /// Sums up the reports of the objects.
    pub(super) fn measure(&mut self) {
        let mut report = BuildReport { build_time: self.report.build_time, ..BuildReport::default() };
        for object in self.objects.iter().flatten() {
            report.add_object(object.report());
        }
        report.nodes += self.top.nodes().len();
        report.bytes += size_of_val(self.top.nodes()) + size_of_val(self.placed.as_slice());
        report.depth += self.top.depth();
        report.sah_cost = self.top.cost();
        report.input = self.input();
        self.report = report;
    }

    /// What was wrong with the triangles, instances counted.
    fn input(&self) -> InputReport {
        let mut sum = InputReport::default();
        for instance in self.instances.iter().flatten() {
            let Some(Some(object)) = self.objects.get(instance.object as usize) else { continue };
            sum += object.report().input;
        }
        sum
    }
}

/// An instance in its place.
pub(super) fn placed(
    index: usize,
    instance: &Instance,
    object: &ObjectStructure,
) -> Result<Placed, SceneError> {
    Placed::new(index as u32, instance.object, instance.mask, &instance.transform, object)
        .map_err(|why| SceneError::Transform { instance: index, why })
}
