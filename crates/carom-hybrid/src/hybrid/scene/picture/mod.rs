//! Pictures of plans: on a line over time, in the plane with equal axes, still or moving, in space
//! from two sides. `plans` are what is shown, `motion` says where bodies are between samples,
//! `view` what is visible, `projection` how space is seen, `obstacles` and `paths` draw, and
//! `words` say it.

mod motion;
mod obstacles;
mod paths;
mod plans;
mod projection;
mod view;
mod words;

pub use plans::ScenePicture;
use view::View;

use super::axes::AXES;
use super::plan::ScenePlan;
use super::statement::Scene;
use crate::error::Error;
use crate::picture::{Chart, Stopwatch, to_svg};

/// How long a moving picture rests at its end before it begins again, in s.
const PAUSE: f64 = 1.2;

/// The axes of a scene in the plane.
const PLANE: [&str; 2] = [AXES[0], AXES[1]];

/// The height of a bar of a race, in pixels, and the part of the picture that the longest one
/// takes.
const BAR: f64 = 24.0;
const LONGEST: f64 = 0.72;

impl ScenePicture {
    /// The still picture.
    pub fn to_svg(&self) -> String {
        if self.scene.axes() > 2 {
            let views = projection::views(self);
            let charts = views.iter().map(|(view, axes)| paths::in_plane(view, *axes));
            return self.finish(charts.collect(), None);
        }
        match View::over_time(self) {
            Some(view) => self.finish(vec![paths::over_time(self, &view)], None),
            None => self.finish(vec![paths::in_plane(self, PLANE)], None),
        }
    }

    /// The picture with bodies that move in the time that the plans take, over and over, with a
    /// rest between, and a clock. Where it is not played, or the reader asks for less motion, it is
    /// the still picture.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for a plan on a line or in
    /// space.
    pub fn to_animation(&self) -> Result<String, Error> {
        let axes = self.scene.axes();
        if axes != 2 {
            let what = "the number of axes of an animation";
            return Err(Error::out_of_range(what, axes as f64, 2.0..=2.0));
        }
        let mut chart = paths::in_plane(self, PLANE);
        let period = self.duration() + PAUSE;
        obstacles::animate(&mut chart, self, period);
        for (motion, colour) in self.motions() {
            chart.animate(motion.mover(colour, period));
        }
        let end = self.duration();
        Ok(self.finish(vec![chart], Some(Stopwatch { end, period })))
    }

    /// The picture, with the bars of a race.
    fn finish(&self, mut charts: Vec<Chart>, clock: Option<Stopwatch>) -> String {
        if self.plans.len() > 1 {
            charts.push(self.bars(clock.as_ref().map(|clock| clock.period)));
        }
        let title = match self.title.is_empty() {
            true => words::title(self),
            false => self.title.clone(),
        };
        to_svg(&charts, &title, &words::about(self), clock)
    }

    /// A bar for each plan, as long as it takes.
    fn bars(&self, period: Option<f64>) -> Chart {
        let count = self.plans.len() as f64;
        let longest = self.duration().max(1e-9);
        let mut chart = Chart::new("time (s)", "")
            .with_size(view::SIZE, BAR * count + 8.0)
            .with_ranges((0.0..=longest / LONGEST).into(), (0.0..=count).into());
        let motions = self.motions();
        let firsts = motions.iter().step_by(self.scene.bodies.len().max(1));
        for (p, ((name, plan), (_, colour))) in self.plans.iter().zip(firsts).enumerate() {
            let (end, low) = (plan.duration(), count - 1.0 - p as f64);
            let corners =
                [[0.0, low + 0.15], [end, low + 0.15], [end, low + 0.85], [0.0, low + 0.85]];
            chart.area("", colour, 0.5, corners);
            let text = format!("{name}: {} s", words::short(end));
            chart.label(text, colour, [end, low + 0.5]);
        }
        if let Some(period) = period {
            chart.animate(motion::hand(longest, count, period));
        }
        chart
    }
}

impl ScenePlan {
    /// A picture of the plan, to give it a title, or rivals.
    ///
    /// # Arguments
    ///
    /// * `scene`: the scene of the plan.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length) for a plan of other bodies;
    /// [`SceneError`](super::SceneError) for a scene that contradicts itself.
    pub fn picture(&self, scene: &Scene) -> Result<ScenePicture, Error> {
        ScenePicture::new(scene, self)
    }

    /// A still picture of the plan; see [`ScenePicture`].
    ///
    /// # Errors
    ///
    /// Those of [`picture`](ScenePlan::picture).
    pub fn to_svg(&self, scene: &Scene) -> Result<String, Error> {
        Ok(self.picture(scene)?.to_svg())
    }

    /// The plan as a moving picture in the plane; see [`ScenePicture::to_animation`].
    ///
    /// # Errors
    ///
    /// Those of [`picture`](ScenePlan::picture) and of [`ScenePicture::to_animation`].
    pub fn to_animation(&self, scene: &Scene) -> Result<String, Error> {
        self.picture(scene)?.to_animation()
    }
}
