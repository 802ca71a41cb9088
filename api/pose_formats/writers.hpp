// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/pose_formats/pose_format.hpp"

/// The numbers of each format, one function a format; what they mean is in the table of pose_format.cpp.
namespace calibrd::api {

void write_matrix(boost::json::object& body, const FramedPose& pose);
void write_quaternion(boost::json::object& body, const FramedPose& pose);
void write_rotvec(boost::json::object& body, const FramedPose& pose);
void write_halcon(boost::json::object& body, const FramedPose& pose);
void write_opencv(boost::json::object& body, const FramedPose& pose);

void write_ros2(boost::json::object& body, const FramedPose& pose);
void write_ros1(boost::json::object& body, const FramedPose& pose);
void write_urdf(boost::json::object& body, const FramedPose& pose);

void write_kuka(boost::json::object& body, const FramedPose& pose);
void write_fanuc(boost::json::object& body, const FramedPose& pose);
void write_yaskawa(boost::json::object& body, const FramedPose& pose);
void write_mitsubishi(boost::json::object& body, const FramedPose& pose);
void write_kawasaki(boost::json::object& body, const FramedPose& pose);
void write_abb(boost::json::object& body, const FramedPose& pose);
void write_ur(boost::json::object& body, const FramedPose& pose);

}  // namespace calibrd::api
