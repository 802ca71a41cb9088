// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What of the daemon's answers the page uses; the whole of them is in /openapi.json. SI units.

/** 4×4, row-major: maps points of the second frame of its name to the first. */
export type Matrix4 = number[][];

/** `open`: nothing that needs a token. */
export type Scope = "open" | "read" | "calibrate" | "admin";
export type PoseState = "uncalibrated" | "calibrated" | "unverified" | "drifted";
export type Verdict = "accepted" | "uncertain" | "rejected";

export interface Session {
  caller: string;
  scope: Scope;
}

export interface Camera {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  /** k1, k2, p1, p2, k3 as OpenCV defines them. */
  distortion: number[];
}

export interface Sensor {
  id: string;
  health: "starting" | "streaming" | "lost";
  reason: string | null;
  device: string | null;
  notice: string | null;
  frame_rate_hz: number;
  frame_age_s: number | null;
  camera: Camera;
  views: { usable: boolean; code: string; reason: string | null };
  job: string | null;
}

export interface Robot {
  model: string;
  base_frame: string;
  controller_frame: string | null;
  link: { state: string; reason: string | null };
  joint_names: string[];
  links: { name: string; T_base_link: Matrix4 }[];
}

export interface Cell {
  version: string;
  uptime_s: number;
  robot: Robot;
  sensors: Sensor[];
}

export interface KnownPose {
  calibration: string;
  calibrated_at: string;
  T_base_sensor: Matrix4;
  sigma_position_m: number;
  sigma_rotation_rad: number;
}

export interface Pose extends Partial<KnownPose> {
  sensor: string;
  valid: boolean;
  state: PoseState;
  reason?: string;
  base_frame: string;
  sensor_frame: string;
  candidate: string | null;
  job: string | null;
  max_unverified_s: number;
  last_check: { agrees: boolean; agreement: number; median_residual_m: number } | null;
  last_known?: KnownPose | null;
  /** From the headers: seconds since then, when the answer was made. */
  calibrated_age_s: number | null;
  passed_check_age_s: number | null;
}

export interface Drift {
  watched: boolean;
  verdict: string;
  meaning: string;
  age_s: number | null;
  statistic: number;
  threshold: number;
  shift: { position_m: number; rotation_rad: number };
  depth_offset_change_m: number;
  healing: "automatic" | "ask" | "off";
  healing_in_s: number | null;
  candidate: string | null;
  series: { age_s: number; statistic: number; shift_m: number; turn_rad: number }[];
  events: { age_s: number; verdict: string }[];
}

export interface CalibrationResult {
  verdict: Verdict;
  T_base_sensor?: Matrix4;
  covariance: (number | null)[][];
  sigma_position_m: number | null;
  sigma_rotation_rad: number | null;
  residual_rms_m: number | null;
  coverage: number | null;
  views: number;
  reasons: { code: string; text: string }[];
  links?: { link: string; predicted: number; coverage: number }[];
  workspace?: { name: string; x: number; y: number; z: number; sigma_m: number | null }[];
}

export interface Calibration {
  id: string;
  sensor: string;
  status: "queued" | "collecting" | "running" | "succeeded" | "failed" | "cancelled";
  verdict: Verdict | null;
  current: boolean;
  progress: number;
  message: string | null;
  created_at: string;
  finished_at: string | null;
  method: string;
  postures: number;
  postures_seen: number;
  activate: boolean;
  result?: CalibrationResult | null;
}

export interface NextPosture {
  joint_names: string[];
  positions_rad: number[];
  expected: { sigma_position_m: number; sigma_rotation_rad: number };
  improves: string;
}

export interface CalibrationDiff {
  a: string;
  b: string;
  translation_mm: number[];
  rotation_mrad: number[];
  distance_mm: number;
  angle_mrad: number;
  workspace: { name: string; displacement_mm: number[]; distance_mm: number; sigma_mm: number | null }[];
}

export interface Joints {
  positions_rad: number[] | null;
  age_s: number | null;
  stale: boolean;
  frozen: boolean;
  still: boolean;
}
