#pragma once

#include "online_controller/estimation/attitude_trim.hpp"
#include "online_controller/estimation/position_integrator.hpp"
#include "online_controller/estimation/sample_line.hpp"
#include "online_controller/laws/control_law.hpp"
#include "online_controller/types/options.hpp"

namespace polyfly {

/// What the laws share that observe the vehicle: time line, trim of the attitude, integral of the position error.
class EstimatingLaw : public ControlLaw {
 public:
  void forget(LawMemory what) noexcept override;

 protected:
  /// `offsets` tells trim and integrator what they may remove.
  EstimatingLaw(const LawTiming& timing, const VehicleModel& model, const MultirotorOptions& options,
                const TiltModel& tilt, const MultirotorOptions& offsets);

  /// The law's own observers forget what they know.
  virtual void resetObservers() noexcept = 0;
  /// As LawMemory::kPlan.
  virtual void forgetPlan() noexcept = 0;
  /// As after construction.
  void forgetAll() noexcept;

  /// Control periods since the sample before; 0: nothing is to be observed, see SampleLine.
  int beginSample(double stamp) noexcept;
  /// The trim learns from the sample, after the law's own observers.
  void observeTrim(const TiltAngles& measured, int periods, const FlownReference& is_flown) noexcept;

  /// Forgets the trim, which a disturbance that is known from elsewhere contains.
  void resetTrim() noexcept;

  /// The part of transferState() that the laws share.
  void transferEstimates(const EstimatingLaw& from) noexcept;

  MultirotorOptions options_;
  AttitudeTrim trim_;
  PositionIntegrator integrator_;
  // By the last command; nothing where another law sent it.
  FollowedReference followed_;

 private:
  SampleLine line_;
};

}  // namespace polyfly
