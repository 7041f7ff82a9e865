// Every reset that forewalk brings along; what each does is in README.md beside this file.
#pragma once

#include <memory>

#include "rdw/reset_policy.h"

namespace forewalk::rdw {

std::unique_ptr<ResetPolicy> makeTwoOneTurn();    ///< two-one-turn
std::unique_ptr<ResetPolicy> makeFreezeTurn();    ///< freeze-turn
std::unique_ptr<ResetPolicy> makeFreezeBackup();  ///< freeze-backup
std::unique_ptr<ResetPolicy> makeR2C();           ///< r2c: to the centre
std::unique_ptr<ResetPolicy> makeMR2C();          ///< mr2c: to the centre, along what is in the way
std::unique_ptr<ResetPolicy> makeR2G();           ///< r2g: down the potential's gradient
std::unique_ptr<ResetPolicy> makeSFR2G();         ///< sfr2g: five steps down it
std::unique_ptr<ResetPolicy> makeR2FD();          ///< r2fd: to a way as free as the virtual one

}  // namespace forewalk::rdw
