-- The workloads as Copilot streams; prints C99 beside this file. To write it again, with Debian's
-- libghc-copilot-dev:
--
--     cd benchmarks/peers/copilot && runghc Workloads.hs
module Main (main) where

import Copilot.Compile.C99 (compile)
import qualified Copilot.Library.MTL as MTL
import Copilot.Library.PTLTL (alwaysBeen, previous)
import Language.Copilot hiding (alwaysBeen, previous, since)
import Prelude ((>>=), IO, String, mapM_, uncurry)

a, b, c :: Stream Bool
a = extern "a" Nothing
b = extern "b" Nothing
c = extern "c" Nothing

-- The ticks, which the operators of MTL ask for.
clock :: Stream Int64
clock = [0] ++ (clock + 1)

-- The library's `since` is another operator: true until q first holds, then false for good once p fails.
since :: Stream Bool -> Stream Bool -> Stream Bool
since p q = s where s = q || (p && ([False] ++ s))

once :: Int64 -> Int64 -> Stream Bool -> Stream Bool
once lo hi = MTL.eventuallyPrev lo hi clock 1

-- Ticks since the last b, 101 for more.
age :: Stream Int32
age = mux b 0 (mux (old > 100) 101 (old + 1)) where old = [101] ++ age

-- Ticks since the oldest trigger without a b, 10 for more; -1 for no such trigger.
open :: Stream Int32
open = mux b (-1) (mux (old > 9) 10 (mux (old >= 0) (old + 1) (mux a 0 (-1)))) where old = [-1] ++ open

workloads :: [(String, Stream Bool)]
workloads =
  [ ("w1_library", not (since (not b) (a && not b)))
  , ("w2_library", alwaysBeen (once 10 10 a ==> once 0 10 b))
  , ("w3_library", alwaysBeen (a ==> once 0 100 b))
  , ("w4_library", alwaysBeen ((a && previous (not a)) ==> since (not c) b))
  , ("w2_counter", alwaysBeen (open < 10))
  , ("w3_counter", alwaysBeen (a ==> (age <= 100)))
  ]

main :: IO ()
main = mapM_ (uncurry emit) workloads
  where emit name stream = reify (trigger "verdict" true [arg stream]) >>= compile name
